#include "posewise/jacobian/identification.hpp"

#include "core/parallel.hpp"
#include "measurement/noise.hpp"
#include "posewise/core/errors.hpp"

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

/// Every pose's rows of the targets it shows: of all rows J those that `finish(motion, repeats, J)`
/// has taken to the front; `make_finish()` makes one for each range of configurations.
template <typename MakeFinish>
Blocks fill_blocks(const Campaign& campaign, const Parameters& parameters,
                   const RowMatrixXd& configurations, const RowMatrixXd& repeats,
                   const MakeFinish& make_finish) {
    for (Index i = 0; i < configurations.rows(); ++i) {
        campaign.robot.check_configuration(configurations.row(i).transpose());
    }
    detail::check_noise(campaign);
    check_repeats(campaign, configurations.rows(), repeats);
    const Sensor& sensor = *campaign.sensor;
    Blocks blocks;
    for (Index i = 0; i < configurations.rows(); ++i) {
        const Index seen = (repeats.row(i).array() > 0).count();
        blocks.first_row.push_back(blocks.first_row.back() + seen * sensor.rows_per_target());
    }
    blocks.matrix.resize(blocks.first_row.back(), parameter_count(campaign));
    detail::for_each_range(configurations.rows(), grain, [&](Index first, Index last) {
        FlangeMotion motion;
        RowMatrixXd J(sensor.row_count(), blocks.parameter_count());
        VectorXd q(configurations.cols());
        VectorXd times(repeats.cols());
        auto finish = make_finish();
        for (Index i = first; i < last; ++i) {
            q = configurations.row(i).transpose();
            times = repeats.row(i).transpose();
            differentiate_pose(campaign, parameters, q, motion, J);
            const Index row = blocks.first_row[static_cast<std::size_t>(i)];
            const Index count = blocks.first_row[static_cast<std::size_t>(i) + 1] - row;
            finish(motion, times, J);
            blocks.matrix.middleRows(row, count) = J.topRows(count);
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
    const Index width = campaign.sensor->rows_per_target();
    const auto take_seen = [width](const FlangeMotion&, const VectorXd& times, RowMatrixXd& J) {
        Index count = 0;
        for (const Index row : seen_rows(times.array() > 0, width)) J.row(count++) = J.row(row);
    };
    return fill_blocks(campaign, parameters, configurations, repeats, [&] { return take_seen; });
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
    // Hidden rows are left out before whitening: what is not observed has no covariance.
    return fill_blocks(campaign, parameters, configurations, repeats, [&] {
        return [&, noise = detail::PoseNoise(campaign)](
                   const FlangeMotion& motion, const VectorXd& times, RowMatrixXd& J) mutable {
            const Index count = noise.whiten_seen(motion, parameters.sensor, times, J);
            J.topRows(count) *= scale.asDiagonal();
        };
    });
}

Blocks make_blocks(const Campaign& campaign, const Parameters& parameters,
                   const RowMatrixXd& configurations, double repeats) {
    return make_blocks(campaign, parameters, configurations,
                       all_so_often(campaign, configurations, repeats));
}

}  // namespace posewise
