#include "nominal_factor.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/decompositions.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise::detail {
namespace {

/// Beside these values rank is nearly lost only.
Parameters nominal_of(const Campaign& campaign) {
    Parameters nominal = campaign.nominal;
    nominal.robot.setZero(campaign.robot.parameter_count());
    return nominal;
}

}  // namespace

VectorXd least_shares_of(const Campaign& campaign) {
    constexpr double least_of_exact = 1e-12;
    VectorXd shares = VectorXd::Constant(parameter_count(campaign), least_visible);
    for (Index k = 0; k < campaign.robot.parameter_count(); ++k) {
        if (campaign.robot.parameter_term(k) == nullptr) continue;
        shares[base_parameter_count(campaign) + k] = least_of_exact;
    }
    if (campaign.sensor->has_pixels()) {
        shares.tail(campaign.nominal.sensor.size()).setConstant(least_of_exact);
    }
    return shares;
}

ShownPoses poses_to_judge(const Campaign& campaign) {
    const Parameters nominal = nominal_of(campaign);
    const Index L = parameter_count(campaign);
    const Sensor& sensor = *campaign.sensor;
    // Weak columns are hardly told from none by fewer.
    constexpr Index usual = 400;
    const Index count = std::min(2 * L, std::max(2 * (L - sensor.unknown_sizes().size()), usual));
    if (sensor.has_view()) {
        return viewed_poses(campaign, nominal, count, configuration_seed);
    }
    auto touching = touching_poses(campaign, nominal, count, configuration_seed);
    return touching ? std::move(*touching)
                    : random_poses(campaign, nominal, count, configuration_seed);
}

VectorXd sizes_of(Campaign campaign) {
    campaign.spread.by_name.clear();
    campaign.spread.offset.reset();
    return parameter_scale(campaign);
}

MatrixXd stack_at_nominal(const Campaign& campaign, const ShownPoses& poses, Index first,
                          Index count) {
    const RowMatrixXd of_poses =
        make_plain_blocks(campaign, nominal_of(campaign),
                          poses.configurations.middleRows(first, count),
                          times_seen(poses.is_seen.middleRows(first, count), 1))
            .matrix;
    const Index told = campaign.sensor->unknown_sizes().size();
    if (told == 0) return of_poses;
    // That something is known of them counts as much as what the poses show.
    const Index begin = parameter_count(campaign) - campaign.nominal.sensor.size();
    const VectorXd norms = of_poses.middleCols(begin, told).colwise().norm().transpose();
    MatrixXd both = MatrixXd::Zero(of_poses.rows() + told, of_poses.cols());
    both.topRows(of_poses.rows()) = of_poses;
    both.block(of_poses.rows(), begin, told, told).diagonal() = norms.cwiseMax(norms.mean());
    return both;
}

MatrixXd factor_at_nominal(const Campaign& campaign, const StopSignal& stop) {
    constexpr Index least_part = 1'000'000;  // numbers; less takes no time
    const Index L = parameter_count(campaign);
    const ShownPoses poses = poses_to_judge(campaign);
    const Index rows = std::max(4 * L, least_part / std::max<Index>(1, L));
    const Index at_once = std::max<Index>(1, rows / campaign.sensor->row_count());
    MatrixXd R(0, L);
    for (Index first = 0; first < poses.configurations.rows(); first += at_once) {
        if (first > 0) stop.check(fmt::format("finding what is identifiable of {} parameters", L));
        const Index count = std::min(at_once, poses.configurations.rows() - first);
        const MatrixXd part = stack_at_nominal(campaign, poses, first, count);
        MatrixXd both(R.rows() + part.rows(), L);
        both << R, part;
        R = triangular_factor(std::move(both));
    }
    return R * sizes_of(campaign).asDiagonal();
}

}  // namespace posewise::detail
