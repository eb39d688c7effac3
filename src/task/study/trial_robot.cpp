#include "trial_robot.hpp"

#include <cmath>

#include "core/statistics.hpp"
#include "measurement/noise.hpp"
#include "task/calibration/identify_anew.hpp"

namespace posewise::detail {
namespace {

/// Where the drawn robot's targets are when it is sent to configurations.
RowMatrixXd visited_positions(const Campaign& truth, const DrawnRobot& robot,
                              const RowMatrixXd& configurations, std::uint64_t seed) {
    RowMatrixXd visited = configurations;
    RandomStream random(seed);
    const Index joints = truth.joint_repeatability.size();  // 0: it repeats exactly
    for (Index i = 0; i < visited.rows() && joints > 0; ++i) {
        visited.row(i).head(joints) +=
            truth.joint_repeatability.cwiseProduct(random.normals(joints)).transpose();
    }
    RowMatrixXd positions = target_positions(truth, robot.truth, visited);
    Campaign own = truth;
    own.model_error = robot.model_error;
    own.model_error_orientation = robot.model_error_orientation;
    const double own_error = std::sqrt(1 - common_part(own)) * own.model_error;
    positions.reshaped() += own_error * random.normals(positions.size());
    const double common = common_model_error(own);
    if (common == 0) return positions;
    RowMatrixXd effect(positions.cols(), 6);
    for (Index i = 0; i < visited.rows(); ++i) {
        const Isometry3d flange = world_from_flange(truth, robot.truth, visited.row(i).transpose());
        truth.sensor->differentiate_positions(flange,
                                              model_error_twists(truth, flange, robot.truth.sensor),
                                              robot.truth.sensor, effect);
        positions.row(i) += common * (effect * random.normals(6)).transpose();
    }
    return positions;
}

}  // namespace

std::uint64_t draw_seed(RandomStream& stream) {
    return static_cast<std::uint64_t>(stream.index(Index{1} << 62));
}

TrialRobot visit(const Campaign& truth, DrawnRobot robot, const RowMatrixXd& test,
                 std::uint64_t seed) {
    TrialRobot trial{truth, std::move(robot), {}};
    trial.truth.model_error = trial.robot.model_error;
    trial.truth.model_error_orientation = trial.robot.model_error_orientation;
    trial.positions = visited_positions(truth, trial.robot, test, seed);
    return trial;
}

std::optional<Estimate> calibrate_robot(const Campaign& campaign, const TrialRobot& trial,
                                        const Subset& subset, Index repeats, std::uint64_t seed) {
    return identify_anew(
        campaign, simulate_measurements(trial.truth, trial.robot.truth, subset.configurations,
                                        subset.is_seen, repeats, seed));
}

RowMatrixXd target_positions(const Campaign& campaign, const Parameters& parameters,
                             const RowMatrixXd& configurations) {
    const Sensor& sensor = *campaign.sensor;
    const Index targets = sensor.position_count();
    RowMatrixXd positions(configurations.rows(), 3 * targets);
    std::vector<Vector3d> on_flange;
    for (Index j = 0; j < targets; ++j) {
        on_flange.push_back(sensor.counted_position(j, parameters.sensor));
    }
    Index i = 0;
    for (const Isometry3d& flange :
         campaign.robot.base_from_flanges(configurations, parameters.robot)) {
        const Isometry3d world_from_flange = parameters.world_from_base * flange;
        for (Index j = 0; j < targets; ++j) {
            positions.row(i).segment<3>(3 * j) =
                (world_from_flange * on_flange[static_cast<std::size_t>(j)]).transpose();
        }
        ++i;
    }
    return positions;
}

HeldOut compare_positions(const RowMatrixXd& is, const RowMatrixXd& should_be) {
    const RowMatrixXd error = is - should_be;
    const Eigen::Map<const RowMatrixXd> points(error.data(), error.size() / 3, 3);
    const VectorXd distances = points.rowwise().norm();
    const auto count = static_cast<double>(distances.size());
    return {distances.size(), std::sqrt(distances.squaredNorm() / count),
            quantile(distances, 0.95, QuantileRule::Upper), distances.maxCoeff()};
}

}  // namespace posewise::detail
