#include <algorithm>
#include <cmath>

#include "core/decompositions.hpp"
#include "core/statistics.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/task/calibration.hpp"

namespace posewise {
namespace {

/// What is on the flange, and the first of its six unknowns among the sensor's.
struct OnFlange {
    bool is_camera = false;
    Isometry3d place = Isometry3d::Identity();
    std::optional<Index> first_unknown;
};

std::optional<OnFlange> find_on_flange(const Campaign& campaign, const VectorXd& unknowns) {
    const Sensor* const sensor = campaign.sensor.get();
    if (const auto* const camera = dynamic_cast<const CameraSensor*>(sensor)) {
        OnFlange found{camera->setup().is_on_flange, camera->place(unknowns), std::nullopt};
        if (!camera->setup().known_place) found.first_unknown = camera->first_of_place();
        return found;
    }
    const auto* const poses = dynamic_cast<const PoseSensor*>(sensor);
    if (poses == nullptr || !poses->record().is_made_at_body) return std::nullopt;
    OnFlange found{true, poses->tool(unknowns), std::nullopt};
    if (!poses->unknown_names().empty()) found.first_unknown = 0;
    return found;
}

MatrixXd carried(const MatrixXd& J, const MatrixXd& covariance) {
    return J * covariance * J.transpose();
}

FoundPlace on_flange(const OnFlange& found, const MatrixXd& covariance) {
    MatrixXd J = MatrixXd::Identity(6, 6);
    J.bottomRightCorner<3, 3>() = rotation_vector_rate(vector_from_rotation(found.place.linear()));
    return {found.place, carried(J, covariance)};
}

/// The world's origin in the base frame, p = -R^T t of a base (R, t) that moves by a translation d
/// and a rotation vector w about its own origin: p moves by R^T (w x t - d), it turns by -R^T w.
FoundPlace at_base(const Isometry3d& world_from_base, const MatrixXd& covariance) {
    const Matrix3d to_base = world_from_base.linear().transpose();
    MatrixXd J = MatrixXd::Zero(6, 6);
    J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = -to_base;
    J.topRightCorner<3, 3>() = -to_base * cross_matrix(world_from_base.translation());
    return {world_from_base.inverse(), carried(J, covariance)};
}

/// Of base.x .. base.rz; those that are known have none.
MatrixXd base_covariance(const Campaign& campaign, const MatrixXd& covariance) {
    std::vector<Index> unknown;
    for (Index k = 0; k < 6; ++k) {
        if (!campaign.base_is_known[static_cast<std::size_t>(k)]) unknown.push_back(k);
    }
    const Index count = std::ssize(unknown);
    MatrixXd all = MatrixXd::Zero(6, 6);
    all(unknown, unknown) = covariance.topLeftCorner(count, count);
    return all;
}

}  // namespace

VectorXd deviations_of(const FoundPlace& found, bool is_along_own) {
    MatrixXd turn = MatrixXd::Identity(6, 6);
    if (is_along_own) {
        turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() =
            found.place.linear().transpose();
    }
    return carried(turn, found.covariance).diagonal().cwiseMax(0).cwiseSqrt();
}

Matrix3d ellipsoid_of(const FoundPlace& found) {
    const auto axes = detail::eigen_decomposition(found.covariance.topLeftCorner(3, 3));
    const double reach = std::sqrt(detail::chi_squared_quantile(0.95, 3));
    const VectorXd lengths = reach * axes.eigenvalues().cwiseMax(0).cwiseSqrt();
    return axes.eigenvectors() * lengths.asDiagonal();
}

std::optional<HandEye> find_hand_eye(const Campaign& campaign, const Estimate& estimate) {
    const auto flange = find_on_flange(campaign, estimate.parameters.sensor);
    if (!flange) return std::nullopt;
    HandEye found{flange->is_camera};
    if (flange->first_unknown) {
        const Index first = base_parameter_count(campaign) + estimate.parameters.robot.size() +
                            *flange->first_unknown;
        found.on_flange = on_flange(*flange, estimate.covariance.block(first, first, 6, 6));
    }
    if (base_parameter_count(campaign) > 0) {
        found.at_base = at_base(estimate.parameters.world_from_base,
                                base_covariance(campaign, estimate.covariance));
    }
    return found;
}

}  // namespace posewise
