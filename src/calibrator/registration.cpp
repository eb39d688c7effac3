#include "posewise/calibrator/registration.hpp"

#include <fmt/format.h>

#include <Eigen/QR>

#include "least_squares.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/model/transforms.hpp"

namespace posewise {
namespace {

/// What the configurations' means say of the sensor's observed points, one sample each.
Measurements as_points(const Measurements& means, const ObservedPoints& observed) {
    Measurements points = means;
    const Index count = observed.points.count();
    points.observations.resize(means.observations.rows(), 3 * count);
    points.is_seen.resize(means.is_seen.rows(), count);
    for (Index i = 0; i < points.observations.rows(); ++i) {
        points.observations.row(i) =
            observed.positions(means.observations.row(i).transpose()).transpose();
        for (Index k = 0; k < count; ++k) {
            points.is_seen(i, k) = means.is_seen(i, k * means.is_seen.cols() / count);
        }
    }
    return points;
}

/// Least squares for (rows of X, c, unknown points) of X p_ij + c - R_i t_j = p_i.
struct LinearEquations {
    MatrixXd A;
    VectorXd b;
};

LinearEquations state_equations(const Campaign& campaign, const Targets& points,
                                const Measurements& means) {
    const Index unknowns = points.unknown_count();
    const Index rows = 3 * means.is_seen.count();
    LinearEquations equations{MatrixXd::Zero(rows, 12 + unknowns), VectorXd(rows)};
    auto& [A, b] = equations;
    Index row = 0;
    for (Index i = 0; i < means.configuration_count(); ++i) {
        const Isometry3d flange = campaign.robot.base_from_flange(
            means.configurations.row(i).transpose(), campaign.nominal.robot);
        for (Index j = 0; j < points.count(); ++j) {
            if (!means.is_seen(i, j)) continue;
            for (Index axis = 0; axis < 3; ++axis) {
                A.block<1, 3>(row + axis, 3 * axis) = means.observation(i, j);
            }
            A.block<3, 3>(row, 9).setIdentity();
            b.segment<3>(row) = flange * points.position(j, VectorXd::Zero(unknowns));
            for (Index axis = 0; axis < 3; ++axis) {
                const Index k = points.unknown_index(j, axis);
                if (k >= 0) A.block<3, 1>(row, 12 + k) = -flange.linear().col(axis);
            }
            row += 3;
        }
    }
    return equations;
}

std::string describe_shortage(const Sensor& sensor, const Measurements& means) {
    const std::string place = sensor.words().place;
    const std::string what = sensor.has_orientation() ? "poses"
                                                      : fmt::format("configurations with {} points",
                                                                    means.is_seen.count());
    return fmt::format(
        "these {} {} do not determine base and {}; more configurations that turn the tool in "
        "different ways are needed or, where all axes are parallel (SCARA), base or {} known along "
        "them, like known: [z]",
        means.configuration_count(), what, place, place);
}

/// Base and sensor's unknowns that solve the linear equations, X projected on the rotations.
Registration solve_linear(const Campaign& campaign, const ObservedPoints& observed,
                          const Measurements& means) {
    const auto [A, b] = state_equations(campaign, observed.points, as_points(means, observed));
    Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
    qr.setThreshold(1e-9);
    if (A.rows() < A.cols() || qr.rank() < A.cols()) {
        return {campaign.nominal, describe_shortage(*campaign.sensor, means)};
    }
    const VectorXd solution = qr.solve(b);
    Parameters found = campaign.nominal;
    const Matrix3d R =
        nearest_rotation(
            Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(solution.data()))
            .transpose();
    found.world_from_base.linear() = R;
    found.world_from_base.translation() = -R * solution.segment<3>(9);
    found.sensor = observed.unknowns(solution.tail(observed.points.unknown_count()));
    return {found, {}};
}

/// Where the polish begins; the robot has no parameters.
Registration find_start(const Campaign& campaign, const Measurements& measurements) {
    const Sensor& sensor = *campaign.sensor;
    std::string unseen = detail::describe_unseen_target(campaign, measurements);
    if (!unseen.empty()) return {campaign.nominal, std::move(unseen)};
    const std::optional<ObservedPoints> observed = sensor.observed_points();
    if (observed && base_parameter_count(campaign) == 6) {
        return solve_linear(campaign, *observed, mean_measurements(sensor, measurements));
    }
    if (!campaign.has_nominal_base || !campaign.has_nominal_targets) {
        throw InputError(fmt::format(
            "base and targets cannot be found from nothing by {} alone or beside a base that is "
            "partly known; the campaign must state base and targets, if only roughly",
            observed ? "lengths" : sensor.words().readings));
    }
    return {campaign.nominal, {}};
}

}  // namespace

Registration register_roughly(const Campaign& campaign, const Measurements& measurements) {
    const Campaign nominal = with_robot(campaign, without_parameters(campaign.robot));
    Registration start = find_start(nominal, measurements);
    start.parameters.robot = VectorXd::Zero(campaign.robot.parameter_count());
    return start;
}

Registration register_base_and_targets(const Campaign& campaign, const Measurements& measurements) {
    const Campaign nominal = with_robot(campaign, without_parameters(campaign.robot));
    Registration registered = register_roughly(nominal, measurements);
    if (registered.is_determined()) {
        Estimate polished = identify(nominal, measurements, registered.parameters);
        registered = {std::move(polished.parameters), std::move(polished.undetermined)};
    }
    registered.parameters.robot = VectorXd::Zero(campaign.robot.parameter_count());
    return registered;
}

Parameters determined(Registration registration) {
    if (!registration.is_determined()) throw InputError(registration.undetermined);
    return std::move(registration.parameters);
}

}  // namespace posewise
