#include "posewise/jacobian/identification.hpp"

#include <algorithm>

#include "core/parallel.hpp"
#include "measurement/noise.hpp"
#include "posewise/core/errors.hpp"
#include "whitened_pose.hpp"

namespace posewise {
namespace {

constexpr Index grain = 8;  // configurations that share memory to work in

void check_repeats(const Campaign& campaign, Index configuration_count,
                   const RowMatrixXd& repeats) {
    const Index targets = campaign.sensor->target_count();
    if (repeats.rows() != configuration_count || repeats.cols() != targets) {
        throw InputError("repeats are stated for " + std::to_string(repeats.rows()) + " x " +
                         std::to_string(repeats.cols()) + " configurations and targets, must be " +
                         std::to_string(configuration_count) + " x " + std::to_string(targets));
    }
    if (!repeats.allFinite() || (repeats.array() < 0).any()) {
        throw InputError("repeats has a value that is negative or not a finite number");
    }
}

/// Every pose's rows of the targets it shows, at most `most_rows`: those that `fill(motion,
/// repeats, rows)` states; `make_fill()` makes one for each range of configurations.
template <typename MakeFill>
Blocks fill_blocks(const Campaign& campaign, const Parameters& parameters,
                   const RowMatrixXd& configurations, const RowMatrixXd& repeats, Index most_rows,
                   const MakeFill& make_fill) {
    for (Index i = 0; i < configurations.rows(); ++i) {
        campaign.robot.check_configuration(configurations.row(i).transpose());
    }
    detail::check_noise(campaign);
    check_repeats(campaign, configurations.rows(), repeats);
    const Sensor& sensor = *campaign.sensor;
    Blocks blocks;
    for (Index i = 0; i < configurations.rows(); ++i) {
        const Index seen = seen_row_count(sensor, repeats.row(i).array() > 0);
        const Index rows = std::min(seen, most_rows);
        blocks.first_row.push_back(blocks.first_row.back() + rows);
    }
    blocks.matrix.resize(blocks.first_row.back(), parameter_count(campaign));
    detail::for_each_range(configurations.rows(), grain, [&](Index first, Index last) {
        FlangeMotion motion;
        VectorXd q(configurations.cols());
        VectorXd times(repeats.cols());
        auto fill = make_fill();
        for (Index i = first; i < last; ++i) {
            q = configurations.row(i).transpose();
            times = repeats.row(i).transpose();
            differentiate_flange(campaign, parameters, q, motion);
            const Index row = blocks.first_row[static_cast<std::size_t>(i)];
            const Index count = blocks.first_row[static_cast<std::size_t>(i) + 1] - row;
            fill(motion, times, blocks.matrix.middleRows(row, count));
        }
    });
    return blocks;
}

/// All targets, each so often.
RowMatrixXd all_so_often(const Campaign& campaign, const RowMatrixXd& configurations,
                         double repeats) {
    return times_seen(all_seen(configurations.rows(), campaign.sensor->target_count()), repeats);
}

}  // namespace

void differentiate_pose(const Campaign& campaign, const Parameters& parameters,
                        const VectorXd& configuration, FlangeMotion& motion,
                        Eigen::Ref<RowMatrixXd> J_measured_parameters) {
    differentiate_flange(campaign, parameters, configuration, motion);
    campaign.sensor->differentiate(motion.world_from_flange, motion.twists, parameters.sensor,
                                   J_measured_parameters);
}

Blocks make_plain_blocks(const Campaign& campaign, const Parameters& parameters,
                         const RowMatrixXd& configurations, const RowMatrixXd& repeats) {
    const Sensor& sensor = *campaign.sensor;
    return fill_blocks(campaign, parameters, configurations, repeats, sensor.row_count(), [&] {
        return [&, J = RowMatrixXd(sensor.row_count(), parameter_count(campaign))](
                   const FlangeMotion& motion, const VectorXd& times,
                   Eigen::Ref<RowMatrixXd> rows) mutable {
            sensor.differentiate(motion.world_from_flange, motion.twists, parameters.sensor, J);
            Index count = 0;
            for (const Index row : seen_rows(sensor, times.array() > 0)) {
                rows.row(count++) = J.row(row);
            }
        };
    });
}

Blocks make_plain_blocks(const Campaign& campaign, const Parameters& parameters,
                         const RowMatrixXd& configurations) {
    return make_plain_blocks(campaign, parameters, configurations,
                             all_so_often(campaign, configurations, 1));
}

Blocks make_position_blocks(const Campaign& campaign, const Parameters& parameters,
                            const RowMatrixXd& configurations) {
    const Index rows = 3 * campaign.sensor->position_count();
    Blocks blocks;
    for (Index i = 0; i < configurations.rows(); ++i) {
        campaign.robot.check_configuration(configurations.row(i).transpose());
        blocks.first_row.push_back(blocks.first_row.back() + rows);
    }
    blocks.matrix.resize(blocks.first_row.back(), parameter_count(campaign));
    detail::for_each_range(configurations.rows(), grain, [&](Index first, Index last) {
        FlangeMotion motion;
        for (Index i = first; i < last; ++i) {
            differentiate_flange(campaign, parameters, configurations.row(i).transpose(), motion);
            campaign.sensor->differentiate_positions(motion.world_from_flange, motion.twists,
                                                     parameters.sensor,
                                                     blocks.matrix.middleRows(rows * i, rows));
        }
    });
    return blocks;
}

Blocks make_blocks(const Campaign& campaign, const Parameters& parameters,
                   const RowMatrixXd& configurations, const RowMatrixXd& repeats) {
    const VectorXd scale = parameter_scale(campaign);
    const Index most_rows = 6 + parameters.sensor.size();
    return fill_blocks(campaign, parameters, configurations, repeats, most_rows, [&] {
        return [&, pose = detail::WhitenedPose(campaign)](const FlangeMotion& motion,
                                                          const VectorXd& times,
                                                          Eigen::Ref<RowMatrixXd> rows) mutable {
            if (rows.rows() == 0) return;
            pose.place(motion, parameters.sensor, times);
            detail::spread(pose.narrow(), motion.twists, rows);
            rows *= scale.asDiagonal();
        };
    });
}

Blocks make_blocks(const Campaign& campaign, const Parameters& parameters,
                   const RowMatrixXd& configurations, double repeats) {
    return make_blocks(campaign, parameters, configurations,
                       all_so_often(campaign, configurations, repeats));
}

}  // namespace posewise
