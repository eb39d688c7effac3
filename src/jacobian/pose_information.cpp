#include "pose_information.hpp"

#include <fmt/format.h>

#include <cmath>

#include "posewise/core/errors.hpp"
#include "whitened_pose.hpp"

namespace posewise::detail {
namespace {

bool is_blind(const SeenTargets& is_seen) { return is_seen.size() > 0 && !is_seen.any(); }

}  // namespace

PoseInformation::PoseInformation(const Campaign& campaign, Parameters parameters, double repeats)
    : campaign_(campaign),
      parameters_(std::move(parameters)),
      repeats_(repeats),
      scale_(parameter_scale(campaign)) {
    check_noise(campaign);
    if (!(repeats > 0) || !std::isfinite(repeats)) {
        throw InputError(fmt::format("repeats is {:g}, must be positive and finite", repeats));
    }
}

VectorXd PoseInformation::repeats(const SeenTargets& is_seen) const {
    const Index targets = campaign_.sensor->target_count();
    const auto times = is_seen.size() == 0 ? times_seen(all_seen(1, targets), repeats_)
                                           : times_seen(is_seen, repeats_);
    return times.transpose();
}

RowMatrixXd PoseInformation::rows(const VectorXd& q, const SeenTargets& is_seen) const {
    if (is_blind(is_seen)) return RowMatrixXd::Zero(0, parameter_count());
    FlangeMotion motion;
    differentiate_flange(campaign_, parameters_, q, motion);
    WhitenedPose pose(campaign_);
    pose.place(motion, parameters_.sensor, repeats(is_seen));
    return block(pose, motion);
}

RowMatrixXd PoseInformation::block(const WhitenedPose& pose, const FlangeMotion& motion) const {
    RowMatrixXd B(pose.narrow().rows(), parameter_count());
    spread(pose.narrow(), motion.twists, B);
    B *= scale_.asDiagonal();
    return B;
}

MatrixXd PoseInformation::evaluate(const VectorXd& q, const SeenTargets& is_seen) const {
    const RowMatrixXd B = rows(q, is_seen);
    MatrixXd M = MatrixXd::Zero(B.cols(), B.cols());
    if (B.rows() == 0) return M;
    M.selfadjointView<Eigen::Lower>().rankUpdate(B.transpose());
    M.triangularView<Eigen::StrictlyUpper>() = M.transpose();
    return M;
}

VectorXd PoseInformation::differentiate(const VectorXd& q, const MatrixXd& Z,
                                        const SeenTargets& is_seen) const {
    return differentiate_weighed(
        q, [&](const RowMatrixXd& B) -> RowMatrixXd { return B * Z; }, is_seen);
}

VectorXd PoseInformation::differentiate_weighed(const VectorXd& q, const Weigh& weigh,
                                                const SeenTargets& is_seen) const {
    if (is_blind(is_seen)) {
        weigh(RowMatrixXd::Zero(0, parameter_count()));
        return VectorXd::Zero(q.size());
    }
    const Sensor& sensor = *campaign_.sensor;
    const VectorXd& unknowns = parameters_.sensor;
    FlangeMotion motion;
    std::vector<FlangeMotionRate> rates;
    differentiate_flange_twice(campaign_, parameters_, q, motion, rates);
    WhitenedPose pose(campaign_);
    pose.place(motion, unknowns, repeats(is_seen));
    const RowMatrixXd B = block(pose, motion);
    const RowMatrixXd BZ = weigh(B);

    const Index moving = motion.twists.cols();
    const RowMatrixXd scaled = BZ * scale_.asDiagonal();
    MatrixXd BZE(BZ.rows(), pose.narrow().cols());
    BZE.leftCols<6>() = scaled.leftCols(moving) * motion.twists.transpose();
    BZE.rightCols(unknowns.size()) = scaled.rightCols(unknowns.size());
    const WhitenedPose::Slopes slopes = pose.slopes(BZE, BZ * B.transpose());
    const TwistMatrix by_twists = pose.narrow().leftCols<6>().transpose() * scaled.leftCols(moving);

    const std::vector<Index>& seen = pose.readings();
    RowMatrixXd A_rate(sensor.row_count(), 6 + unknowns.size());
    VectorXd gradient(q.size());
    for (Index j = 0; j < q.size(); ++j) {
        const FlangeMotionRate& rate = rates[static_cast<std::size_t>(j)];
        const Twist direction = motion.joint_twists.col(j);
        sensor.differentiate_along(motion.world_from_flange, TwistMatrix::Identity(6, 6), direction,
                                   TwistMatrix::Zero(6, 6), unknowns, A_rate);
        const Matrix6d C_rate = flange_covariance_rate(campaign_, motion, j, rate, unknowns);
        gradient[j] = 2 * slopes.by_A.cwiseProduct(A_rate(seen, Eigen::all)).sum() +
                      2 * by_twists.cwiseProduct(rate.twists).sum() -
                      slopes.by_C.cwiseProduct(C_rate).sum();
        if (sensor.has_constant_covariance()) continue;
        const MatrixXd N_rate =
            sensor.covariance_rate(motion.world_from_flange, direction, unknowns) / repeats_;
        gradient[j] -= slopes.by_N.cwiseProduct(N_rate(seen, seen)).sum();
    }
    return gradient;
}

}  // namespace posewise::detail
