#include <fmt/format.h>

#include <algorithm>

#include "core/text.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise {
namespace {

// The three rows of one target over all columns, through plain pointers that share nothing: these
// are the hot loops of planning, and become vectors'. A twist is six numbers, w and v, `count`
// apart.

/// Rows become v + w cross point.
void set_point_rows(const double* __restrict twist, Index count, Vector3d point,
                    double* __restrict x, double* __restrict y, double* __restrict z) {
    for (Index k = 0; k < count; ++k) {
        const double wx = twist[k];
        const double wy = twist[k + count];
        const double wz = twist[k + 2 * count];
        x[k] = twist[k + 3 * count] + (wy * point.z() - wz * point.y());
        y[k] = twist[k + 4 * count] + (wz * point.x() - wx * point.z());
        z[k] = twist[k + 5 * count] + (wx * point.y() - wy * point.x());
    }
}

/// Adds w cross point to them.
void add_turn(const double* __restrict twist, Index count, Vector3d point, double* __restrict x,
              double* __restrict y, double* __restrict z) {
    for (Index k = 0; k < count; ++k) {
        const double wx = twist[k];
        const double wy = twist[k + count];
        const double wz = twist[k + 2 * count];
        x[k] += wy * point.z() - wz * point.y();
        y[k] += wz * point.x() - wx * point.z();
        z[k] += wx * point.y() - wy * point.x();
    }
}

/// Calls one of them with the rows of a target, which may have no columns.
template <typename Fill>
void fill_rows(const Fill& fill, const TwistMatrix& twists, const Vector3d& point, Index target,
               Eigen::Ref<RowMatrixXd> J) {
    fill(twists.data(), twists.cols(), point, J.row(3 * target).data(),
         J.row(3 * target + 1).data(), J.row(3 * target + 2).data());
}

std::vector<Vector3d> values_of(const std::vector<std::optional<Vector3d>>& positions) {
    std::vector<Vector3d> values;
    for (const auto& position : positions) values.push_back(position.value_or(Vector3d::Zero()));
    return values;
}

std::vector<std::array<bool, 3>> marks_of(const std::vector<std::optional<Vector3d>>& positions) {
    std::vector<std::array<bool, 3>> marks;
    for (const auto& position : positions) {
        const bool is_known = position.has_value();
        marks.push_back({is_known, is_known, is_known});
    }
    return marks;
}

}  // namespace

Targets::Targets(const std::vector<std::optional<Vector3d>>& known_positions, Index unknowns_before)
    : Targets(values_of(known_positions), marks_of(known_positions), unknowns_before) {}

Targets::Targets(std::vector<Vector3d> positions, std::vector<std::array<bool, 3>> is_known,
                 Index unknowns_before)
    : known_(std::move(positions)) {
    if (known_.empty()) throw InputError("a sensor needs at least one target");
    for (std::size_t j = 0; j < known_.size(); ++j) {
        std::array<Index, 3> indices{-1, -1, -1};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            double& coordinate = known_[j][static_cast<Index>(axis)];
            if (!is_known[j][axis]) {
                indices[axis] = unknowns_before + unknown_count_++;
                coordinate = 0;
            } else if (!std::isfinite(coordinate)) {
                throw InputError(
                    "a known target's position has a value that is not a finite number");
            }
        }
        unknown_index_.push_back(indices);
    }
}

std::vector<std::string> Targets::unknown_names() const {
    std::vector<std::string> names;
    for (Index j = 0; j < count(); ++j) {
        for (Index axis = 0; axis < 3; ++axis) {
            if (unknown_index(j, axis) < 0) continue;
            names.push_back("target" + std::to_string(j + 1) + '.' + "xyz"[axis]);
        }
    }
    return names;
}

Targets Targets::with_radius(double radius) const {
    constexpr double largest = 1;  // m
    if (!(radius >= 0 && radius <= largest)) {
        throw InputError(
            fmt::format("the targets' radius is {:g} m, must be from 0 to 1 m", radius));
    }
    Targets balls = *this;
    balls.radius_ = radius;
    return balls;
}

bool Targets::is_known(Index target) const {
    const auto& indices = unknown_index_[static_cast<std::size_t>(target)];
    return std::all_of(indices.begin(), indices.end(), [](Index index) { return index < 0; });
}

Vector3d Targets::position(Index target, const VectorXd& unknowns) const {
    Vector3d position = known_[static_cast<std::size_t>(target)];
    for (Index axis = 0; axis < 3; ++axis) {
        const Index index = unknown_index(target, axis);
        if (index >= 0) position[axis] = unknowns[index];
    }
    return position;
}

void Targets::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                            const VectorXd& unknowns,
                            Eigen::Ref<RowMatrixXd> J_positions_parameters) const {
    auto J_unknowns =
        J_positions_parameters.rightCols(J_positions_parameters.cols() - twists.cols());
    J_unknowns.setZero();
    for (Index j = 0; j < count(); ++j) {
        const Vector3d x = world_from_flange * position(j, unknowns);
        fill_rows(set_point_rows, twists, x, j, J_positions_parameters);
        for (Index axis = 0; axis < 3 && J_unknowns.cols() > 0; ++axis) {
            const Index index = unknown_index(j, axis);
            if (index < 0) continue;
            J_unknowns.block<3, 1>(3 * j, index) = world_from_flange.linear().col(axis);
        }
    }
}

void Targets::differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                  const Twist& direction, const TwistMatrix& twist_rates,
                                  const VectorXd& unknowns, Eigen::Ref<RowMatrixXd> J_rate) const {
    auto J_unknowns = J_rate.rightCols(J_rate.cols() - twists.cols());
    J_unknowns.setZero();
    const Vector3d w = direction.head<3>();
    for (Index j = 0; j < count(); ++j) {
        const Vector3d x = world_from_flange * position(j, unknowns);
        const Vector3d velocity = velocity_of(x, direction);
        fill_rows(set_point_rows, twist_rates, x, j, J_rate);
        fill_rows(add_turn, twists, velocity, j, J_rate);
        for (Index axis = 0; axis < 3 && J_unknowns.cols() > 0; ++axis) {
            const Index index = unknown_index(j, axis);
            if (index < 0) continue;
            J_unknowns.block<3, 1>(3 * j, index) = w.cross(world_from_flange.linear().col(axis));
        }
    }
}

std::string describe(const Targets& targets) {
    Index known = 0;
    for (Index j = 0; j < targets.count(); ++j) known += targets.is_known(j) ? 1 : 0;
    return fmt::format("{} ({} known, {} to be identified)",
                       detail::count_of(targets.count(), "target"), known, targets.count() - known);
}

}  // namespace posewise
