#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/decompositions.hpp"
#include "model/element_amount.hpp"
#include "model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/task/correction.hpp"

namespace posewise {
namespace {

using Shape = MapFactor::Shape;
using Terms = std::map<std::vector<MapFactor>, VectorXd>;

double evaluate(const MapFactor& factor, const VectorXd& q) {
    switch (factor.shape) {
        case Shape::Power:
            return std::pow(q[factor.joint], factor.order);
        case Shape::Cosine:
            return std::cos(factor.order * q[factor.joint]);
        default:
            return std::sin(factor.order * q[factor.joint]);
    }
}

/// A sine, or what is in proportion to, one joint's value.
bool is_of_one_joint(const JointFunction& function) {
    return function.torque == nullptr && function.joints.size() == 1;
}

/// Errors that joints seem to have, of the elements that joints drive.
class JointErrors {
  public:
    JointErrors(const Chain& robot, const VectorXd& parameters)
        : robot_(robot), parameters_(parameters) {
        std::vector<VectorXd> rows;
        Index next = 0;
        for (std::size_t e = 0; e < robot.elements().size(); ++e) {
            const Element& element = robot.elements()[e];
            if (!element.parameter.empty()) ++next;
            if (!element.joints.empty()) {
                VectorXd row = VectorXd::Zero(robot.joint_count());
                for (const JointTerm& term : element.joints) row[term.joint] += term.coefficient;
                rows.push_back(row);
                driven_.push_back({e, next});
            }
            next += std::ssize(element.terms);
        }
        MatrixXd driving(std::ssize(rows), robot.joint_count());
        for (std::size_t k = 0; k < rows.size(); ++k)
            driving.row(static_cast<Index>(k)) = rows[k].transpose();
        const MatrixXd each = MatrixXd::Identity(driving.rows(), driving.rows());
        by_element_ = detail::solve_least_squares(driving, each);
    }

    /// Those of one joint alone, as they are.
    void add_simple(Terms& terms) const {
        visit([&](Index element, const JointFunction& function, double parameter) {
            if (!is_of_one_joint(function)) return;
            const VectorXd amounts = parameter * by_element_.col(element);
            const JointTerm& joint = function.joints.front();
            if (function.shape == JointFunction::Shape::Linear) {
                add(terms, {}, function.phase * amounts);
                add(terms, {{joint.joint, Shape::Power, 1}}, joint.coefficient * amounts);
            } else {
                const double order = std::abs(joint.coefficient);
                const double sign = joint.coefficient < 0 ? -1 : 1;
                add(terms, {{joint.joint, Shape::Cosine, order}},
                    std::sin(function.phase) * amounts);
                add(terms, {{joint.joint, Shape::Sine, order}},
                    sign * std::cos(function.phase) * amounts);
            }
        });
    }

    /// The others.
    VectorXd value_at(const VectorXd& q) const {
        VectorXd sum = VectorXd::Zero(robot_.joint_count());
        visit([&](Index element, const JointFunction& function, double parameter) {
            if (is_of_one_joint(function)) return;
            sum += parameter * detail::evaluate(function, q).value * by_element_.col(element);
        });
        return sum;
    }

    static void add(Terms& terms, const std::vector<MapFactor>& factors, const VectorXd& amounts) {
        const auto [place, is_new] = terms.try_emplace(factors, amounts);
        if (!is_new) place->second += amounts;
    }

  private:
    struct Driven {
        std::size_t element = 0;
        Index first = 0;  ///< error parameter of its first term
    };

    template <typename Visit>
    void visit(const Visit& visit) const {
        for (std::size_t k = 0; k < driven_.size(); ++k) {
            Index next = driven_[k].first;
            for (const ErrorTerm& term : robot_.elements()[driven_[k].element].terms) {
                const double parameter = parameters_[next++];
                if (parameter != 0) visit(static_cast<Index>(k), term.function, parameter);
            }
        }
    }

    const Chain& robot_;
    const VectorXd& parameters_;
    std::vector<Driven> driven_;
    MatrixXd by_element_;  ///< joints x driven elements
};

/// Where a joint stands on the grid, and what its values there are a sum of.
struct GridAxis {
    std::vector<double> nodes;
    std::vector<std::vector<MapFactor>> factors;  ///< one or none each
    MatrixXd coefficients_from_values;
};

GridAxis axis_of(const Chain& robot, Index joint) {
    GridAxis axis;
    const Joint& one = robot.joint(joint);
    if (one.motion == Motion::Rotation) {
        constexpr int nodes = 5;
        for (int k = 0; k < nodes; ++k) axis.nodes.push_back(2 * std::numbers::pi * k / nodes);
        axis.factors = {{},
                        {{joint, Shape::Cosine, 1}},
                        {{joint, Shape::Sine, 1}},
                        {{joint, Shape::Cosine, 2}},
                        {{joint, Shape::Sine, 2}}};
    } else {
        axis.nodes = {one.lower, one.upper};
        axis.factors = {{}, {{joint, Shape::Power, 1}}};
    }
    const Index count = std::ssize(axis.nodes);
    MatrixXd values(count, count);
    VectorXd q = VectorXd::Zero(robot.joint_count());
    for (Index i = 0; i < count; ++i) {
        q[joint] = axis.nodes[static_cast<std::size_t>(i)];
        for (Index k = 0; k < count; ++k) {
            const auto& factors = axis.factors[static_cast<std::size_t>(k)];
            values(i, k) = factors.empty() ? 1 : evaluate(factors.front(), q);
        }
    }
    const MatrixXd each = MatrixXd::Identity(count, count);
    axis.coefficients_from_values = detail::solve_least_squares(values, each);
    return axis;
}

/// Values over a grid, one axis a joint; the last joint is next to itself in memory.
class FourierGrid {
  public:
    explicit FourierGrid(const Chain& robot) : joint_count_(robot.joint_count()) {
        for (Index j = 0; j < joint_count_; ++j) axes_.push_back(axis_of(robot, j));
        for (const GridAxis& axis : axes_) size_ *= std::ssize(axis.nodes);
    }

    void add_terms(const JointErrors& errors, Terms& terms) const {
        MatrixXd values(size_, joint_count_);
        VectorXd q(joint_count_);
        for (Index i = 0; i < size_; ++i) {
            each_axis(i, [&](Index j, std::size_t k) { q[j] = axis(j).nodes[k]; });
            values.row(i) = errors.value_at(q).transpose();
        }
        transform(values);
        for (Index i = 0; i < size_; ++i) {
            if (values.row(i).cwiseAbs().maxCoeff() < rounding) continue;
            std::vector<MapFactor> factors;
            each_axis(i, [&](Index j, std::size_t k) {
                factors.insert(factors.end(), axis(j).factors[k].begin(), axis(j).factors[k].end());
            });
            JointErrors::add(terms, factors, values.row(i).transpose());
        }
    }

  private:
    static constexpr double rounding = 1e-13;  // rad, m

    const GridAxis& axis(Index joint) const { return axes_[static_cast<std::size_t>(joint)]; }

    template <typename Visit>
    void each_axis(Index number, const Visit& visit) const {
        for (Index j = joint_count_ - 1; j >= 0; --j) {
            const Index count = std::ssize(axis(j).nodes);
            visit(j, static_cast<std::size_t>(number % count));
            number /= count;
        }
    }

    /// Values at the nodes to coefficients, one axis after another.
    void transform(MatrixXd& values) const {
        Index stride = 1;
        for (Index j = joint_count_ - 1; j >= 0; --j) {
            const Index count = std::ssize(axis(j).nodes);
            MatrixXd line(count, joint_count_);
            for (Index i = 0; i < size_; ++i) {
                if (i / stride % count != 0) continue;
                for (Index k = 0; k < count; ++k) line.row(k) = values.row(i + k * stride);
                const MatrixXd coefficients = axis(j).coefficients_from_values * line;
                for (Index k = 0; k < count; ++k) values.row(i + k * stride) = coefficients.row(k);
            }
            stride *= count;
        }
    }

    Index joint_count_;
    std::vector<GridAxis> axes_;
    Index size_ = 1;
};

/// Factors stand by joint.
std::vector<MapTerm> largest_first(const Terms& all, double negligible) {
    std::vector<MapTerm> terms;
    for (const auto& [factors, amounts] : all) {
        MapTerm& term = terms.emplace_back(MapTerm{factors, amounts});
        std::ranges::sort(term.factors);
    }
    const auto size = [](const MapTerm& term) { return term.amounts.cwiseAbs().maxCoeff(); };
    std::ranges::stable_sort(terms, std::greater<>{}, size);
    for (double left_out = 0; !terms.empty(); terms.pop_back()) {
        left_out += size(terms.back());
        if (left_out > negligible) break;
    }
    return terms;
}

/// The error parameters without those of terms.
VectorXd constant_errors(const Chain& robot, const VectorXd& parameters) {
    VectorXd constant = parameters;
    for (Index k = 0; k < parameters.size(); ++k) {
        if (robot.parameter_term(k) != nullptr) constant[k] = 0;
    }
    return constant;
}

class ErrorFinder {
  public:
    ErrorFinder(const Campaign& campaign, const Parameters& found)
        : robot_(campaign.robot),
          errors_(found.robot),
          constant_(constant_errors(campaign.robot, found.robot)) {
        if (!campaign.sensor->observes_targets()) {
            points_.push_back(Vector3d::Zero());
            return;
        }
        for (Index target = 0; target < campaign.sensor->target_count(); ++target) {
            points_.push_back(campaign.sensor->target_position(target, found.sensor));
        }
    }

    template <typename Send>
    MapError find(const RowMatrixXd& poses, const Send& send) const {
        std::vector<double> distances;
        double squares = 0;
        double angles = 0;
        for (Index i = 0; i < poses.rows(); ++i) {
            const VectorXd q = poses.row(i).transpose();
            const Isometry3d wanted = robot_.base_from_flange(q, constant_);
            const Isometry3d there = robot_.base_from_flange(send(q), errors_);
            for (const Vector3d& point : points_) {
                distances.push_back((there * point - wanted * point).norm());
                squares += distances.back() * distances.back();
            }
            const Matrix3d left = wanted.linear().transpose() * there.linear();
            angles += vector_from_rotation(left).squaredNorm();
        }
        std::ranges::sort(distances);
        constexpr double most = 0.95;
        const auto count = static_cast<double>(distances.size());
        MapError error;
        error.rms = std::sqrt(squares / count);
        error.p95 = distances[static_cast<std::size_t>(most * (count - 1))];
        error.largest = distances.back();
        error.orientation = std::sqrt(angles / static_cast<double>(poses.rows()));
        return error;
    }

  private:
    const Chain& robot_;
    const VectorXd& errors_;
    VectorXd constant_;
    std::vector<Vector3d> points_;
};

}  // namespace

CorrectionMap correction_map(const Campaign& campaign, const Parameters& found,
                             const MapOptions& options) {
    const Chain& robot = campaign.robot;
    if (!robot.torques().empty()) {
        throw InputError("the robot measures torques; a map is of joint values only");
    }
    constexpr Index most_joints = 7;
    if (robot.joint_count() > most_joints) {
        throw InputError(fmt::format("the robot has {} joints; a map is of at most {}",
                                     robot.joint_count(), most_joints));
    }
    CorrectionMap map;
    map.robot = robot;
    const JointErrors errors(robot, found.robot);
    Terms terms;
    errors.add_simple(terms);
    FourierGrid(robot).add_terms(errors, terms);
    map.terms = largest_first(terms, options.negligible);
    if (map.terms.empty()) {
        throw InputError(
            "no error found moves a joint with the configuration; the geometry has all of it");
    }
    map.pose_count = options.pose_count;
    const RowMatrixXd poses =
        detail::random_configurations(robot, options.pose_count, options.seed);
    const ErrorFinder finder(campaign, found);
    map.geometry_alone = finder.find(poses, [](const VectorXd& q) { return q; });
    map.with_map = finder.find(poses, [&](const VectorXd& q) { return joints_to_send(map, q); });
    return map;
}

VectorXd value_at(const CorrectionMap& map, const VectorXd& q) {
    VectorXd sum = VectorXd::Zero(map.robot.joint_count());
    for (const MapTerm& term : map.terms) {
        double product = 1;
        for (const MapFactor& factor : term.factors) product *= evaluate(factor, q);
        sum += product * term.amounts;
    }
    return sum;
}

VectorXd joints_to_send(const CorrectionMap& map, const VectorXd& q) {
    constexpr int steps = 3;
    VectorXd sent = q;
    for (int k = 0; k < steps; ++k) sent = q - value_at(map, sent);
    return sent;
}

}  // namespace posewise
