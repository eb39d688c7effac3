#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "posewise/core/types.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {

/// Radius of the ball that a laser tracker looks at, 1.5 inch across, m.
inline constexpr double tracker_ball_radius = 0.01905;

/// Points fixed to the flange. Each coordinate of each position in the flange frame is known or an
/// unknown of the sensor that looks at them; targets' unknowns come first among the sensor's.
class Targets {
  public:
    /// Whole positions, known (m) or not. Throws InputError if there is none or one is not finite.
    explicit Targets(const std::vector<std::optional<Vector3d>>& known_positions);
    /// Positions (m) of which only the coordinates marked are known; the others are not looked at.
    Targets(std::vector<Vector3d> positions, std::vector<std::array<bool, 3>> is_known);

    /// The same points as centres of balls of this radius, m. Throws InputError if it is negative,
    /// not finite or above 1 m.
    Targets with_radius(double radius) const;
    /// Nothing: not stated.
    std::optional<double> radius() const { return radius_; }

    Index count() const { return static_cast<Index>(known_.size()); }
    Index unknown_count() const { return unknown_count_; }
    /// "target1.x", ... of the unknown coordinates.
    std::vector<std::string> unknown_names() const;

    /// Where a coordinate is among the unknowns; -1 if it is known.
    Index unknown_index(Index target, Index axis) const {
        return unknown_index_[static_cast<std::size_t>(target)][static_cast<std::size_t>(axis)];
    }
    /// Whether all of its coordinates are known.
    bool is_known(Index target) const;
    /// Position in the flange frame, m.
    Vector3d position(Index target, const VectorXd& unknowns) const;

    /// Derivative of the positions in the world by flange motions and by unknowns: 3 count() x
    /// (twists.cols() + any columns of unknowns, those after unknown_count() zero), or without the
    /// unknowns' columns.
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns,
                       Eigen::Ref<RowMatrixXd> J_positions_parameters) const;
    /// Its rate while the flange moves by `direction` and the twists change at `twist_rates`.
    void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                             const Twist& direction, const TwistMatrix& twist_rates,
                             const VectorXd& unknowns, Eigen::Ref<RowMatrixXd> J_rate) const;

  private:
    std::vector<Vector3d> known_;  ///< coordinates that are unknown hold anything finite
    std::vector<std::array<Index, 3>> unknown_index_;
    Index unknown_count_ = 0;
    std::optional<double> radius_;
};

/// "3 targets (1 known, 2 to be identified)".
std::string describe(const Targets& targets);

/// Velocity of a point that moves with a twist (angular w; velocity v of the point at the origin).
inline Vector3d velocity_of(const Vector3d& point, const Twist& twist) {
    return twist.tail<3>() + twist.head<3>().cross(point);
}

}  // namespace posewise
