#include <cmath>

#include "core/elementary.hpp"
#include "element_amount.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise {
namespace {

using detail::amount_of;
using detail::evaluate;
using detail::FunctionValue;
using detail::sum_of;

/// world_from_base * E_1 * ... * E_k, kept as rotation and position because an elementary
/// transform touches only two columns of the one or one combination of the other.
struct RunningProduct {
    Matrix3d R;
    Vector3d p;

    [[gnu::always_inline]] void append(Motion motion, Axis axis, double amount) {
        const auto a = static_cast<Index>(axis);
        if (motion == Motion::Translation) {
            p += amount * R.col(a);
            return;
        }
        if (amount == 0) return;  // as many have that stand for an error only
        const auto [s, c] = detail::sine_and_cosine(amount);
        const Index i = (a + 1) % 3;
        const Index j = (a + 2) % 3;
        const Vector3d column = R.col(i);
        R.col(i) = c * column + s * R.col(j);
        R.col(j) = c * R.col(j) - s * column;
    }

    /// How what follows moves by a further amount along or about the axis.
    [[gnu::always_inline]] Twist twist(Motion motion, Axis axis) const {
        const Vector3d direction = R.col(static_cast<Index>(axis));
        Twist result;
        if (motion == Motion::Rotation) {
            result << direction, p.cross(direction);
        } else {
            result << Vector3d::Zero(), direction;
        }
        return result;
    }

    Isometry3d pose() const {
        Isometry3d T;
        T.linear() = R;
        T.translation() = p;
        T.makeAffine();
        return T;
    }
};

/// [a, b]: the rate of twist b when what it belongs to moves by twist a.
Twist lie_bracket(const Twist& a, const Twist& b) {
    const Vector3d w = a.head<3>();
    Twist result;
    result << w.cross(b.head<3>()), w.cross(b.tail<3>()) + a.tail<3>().cross(b.head<3>());
    return result;
}

/// A function of shape Torque: the torque, or its product with a sum of joints.
TorqueShare torque_times_sum(const JointFunction& function, const VectorXd& q, bool is_twice) {
    TorqueShare share =
        is_twice ? function.torque->evaluate_twice(q) : function.torque->evaluate(q);
    if (function.joints.empty()) return share;
    const double u = detail::torque_factor(function, q);
    VectorXd slope = VectorXd::Zero(share.gradient.size());
    for (const JointTerm& by : function.joints) {
        if (by.joint < slope.size()) slope[by.joint] += by.coefficient;
    }
    if (is_twice) {
        const MatrixXd half = share.gradient * slope.transpose();
        share.hessian = u * share.hessian + half + half.transpose();
    }
    share.gradient = u * share.gradient + share.value * slope;
    share.value *= u;
    return share;
}

/// f(q); adds to the joints' twists, if there are any, what `coefficient` times it moves.
double add_function(const JointFunction& function, double coefficient, const VectorXd& q,
                    const Twist& twist, FlangeMotion& motion) {
    if (motion.joint_twists.cols() == 0) return evaluate(function, q).value;
    if (function.torque != nullptr) {
        const TorqueShare share = torque_times_sum(function, q, false);
        motion.joint_twists += coefficient * twist * share.gradient.transpose();
        return share.value;
    }
    const FunctionValue f = evaluate(function, q);
    for (const JointTerm& by : function.joints) {
        if (by.joint >= motion.joint_twists.cols()) continue;  // a measured torque
        motion.joint_twists.col(by.joint) += coefficient * f.slope * by.coefficient * twist;
    }
    return f.value;
}

/// What the terms of an element, error parameters `next` on, add to `motion`; returns what they add
/// to its amount. Out of line, as add_term_rates() is, so that elements without terms stay fast.
[[gnu::noinline]] double add_terms(const Element& element, const VectorXd& q,
                                   const VectorXd& parameters, const Twist& twist, Index& next,
                                   FlangeMotion& motion) {
    double amount = 0;
    for (const ErrorTerm& term : element.terms) {
        const double pi = parameters[next];
        const double value = add_function(term.function, pi, q, twist, motion);
        motion.twists.col(6 + next++) = value * twist;
        amount += pi * value;
    }
    for (const KnownTerm& term : element.known_terms) {
        amount +=
            term.coefficient * add_function(term.function, term.coefficient, q, twist, motion);
    }
    return amount;
}

/// What coefficient * f(q), part of the amount of an element, adds to the rates: the element's
/// twist, which joint j changes by column j of `changes`, is multiplied by pi df/dq_i in the column
/// of joint i and by f(q) in that of the error parameter k (-1: there is none).
void add_function_rates(const JointFunction& function, double coefficient, const VectorXd& q,
                        const Twist& twist, Index k, const TwistMatrix& changes,
                        std::vector<FlangeMotionRate>& rates) {
    // Errors that are 0, as all are before one is known, move no joint's twist.
    const bool moves_joints = coefficient != 0;
    const bool is_torque = function.torque != nullptr;
    const TorqueShare share =
        is_torque ? torque_times_sum(function, q, moves_joints) : TorqueShare{};
    const FunctionValue f = is_torque ? FunctionValue{} : evaluate(function, q);
    for (Index j = 0; j < changes.cols(); ++j) {
        const auto change = changes.col(j);
        FlangeMotionRate& rate = rates[static_cast<std::size_t>(j)];
        if (is_torque) {
            if (k >= 0) {
                rate.twists.col(6 + k) = share.value * change + share.gradient[j] * twist;
            }
            if (!moves_joints) continue;
            rate.joint_twists +=
                coefficient * (change * share.gradient.transpose() + twist * share.hessian.row(j));
            continue;
        }
        double du_dqj = 0;
        for (const JointTerm& by : function.joints) {
            if (by.joint == j) du_dqj += by.coefficient;
        }
        if (k >= 0) rate.twists.col(6 + k) = f.value * change + f.slope * du_dqj * twist;
        if (!moves_joints) continue;
        for (const JointTerm& by : function.joints) {
            if (by.joint >= rate.joint_twists.cols()) continue;  // a measured torque
            rate.joint_twists.col(by.joint) +=
                coefficient * by.coefficient * (f.slope * change + f.curvature * du_dqj * twist);
        }
    }
}

/// The same of all terms of an element, error parameters k on.
[[gnu::noinline]] void add_term_rates(const Element& element, const VectorXd& q,
                                      const VectorXd& parameters, const Twist& twist, Index k,
                                      const TwistMatrix& changes,
                                      std::vector<FlangeMotionRate>& rates) {
    for (const ErrorTerm& term : element.terms) {
        add_function_rates(term.function, parameters[k], q, twist, k, changes, rates);
        ++k;
    }
    for (const KnownTerm& term : element.known_terms) {
        add_function_rates(term.function, term.coefficient, q, twist, -1, changes, rates);
    }
}

}  // namespace

Isometry3d Chain::base_from_flange(const VectorXd& q, const VectorXd& parameters) const {
    RunningProduct product{Matrix3d::Identity(), Vector3d::Zero()};
    Index k = 0;
    for (const Element& element : elements()) {
        product.append(element.motion, element.axis, amount_of(element, q, parameters, k));
    }
    return product.pose();
}

/// One pass over the elements. After an element that moves something has added its twist to its
/// columns of `motion`, visit(element, twist, parameter) is called with the number of its first
/// error parameter.
template <typename Visit>
void Chain::walk(const Isometry3d& world_from_base, const VectorXd& q, const VectorXd& parameters,
                 FlangeMotion& motion, bool by_joints, const Visit& visit) const {
    motion.twists.resize(6, 6 + parameter_count());
    motion.joint_twists.setZero(6, by_joints ? joint_count() : 0);
    const Vector3d base = world_from_base.translation();
    for (Index axis = 0; axis < 3; ++axis) {
        const Vector3d unit = Vector3d::Unit(axis);
        motion.twists.col(axis) << Vector3d::Zero(), unit;
        motion.twists.col(3 + axis) << unit, base.cross(unit);
    }
    RunningProduct product{world_from_base.linear(), base};
    Index next = 0;
    for (const Element& element : elements()) {
        const Index first = next;
        double amount = sum_of(element.value, element.joints, q);
        if (!element.parameter.empty()) amount += parameters[next++];
        if (next > first || !element.joints.empty() || element.has_functions()) {
            const Twist twist = product.twist(element.motion, element.axis);
            if (next > first) motion.twists.col(6 + first) = twist;
            if (by_joints) {
                for (const JointTerm& term : element.joints) {
                    motion.joint_twists.col(term.joint) += term.coefficient * twist;
                }
            }
            if (element.has_functions()) {
                amount += add_terms(element, q, parameters, twist, next, motion);
            }
            visit(element, twist, first);
        }
        product.append(element.motion, element.axis, amount);
    }
    motion.world_from_flange = product.pose();
}

std::vector<Isometry3d> Chain::base_from_links(const VectorXd& q,
                                               const VectorXd& parameters) const {
    std::vector<Isometry3d> links(joints().size() + 2, Isometry3d::Identity());
    std::vector<bool> is_found(joints().size(), false);
    RunningProduct product{Matrix3d::Identity(), Vector3d::Zero()};
    Index k = 0;
    for (const Element& element : elements()) {
        product.append(element.motion, element.axis, amount_of(element, q, parameters, k));
        for (const JointTerm& term : element.joints) {
            const auto joint = static_cast<std::size_t>(term.joint);
            if (!is_found[joint]) links[joint + 1] = product.pose();
            is_found[joint] = true;
        }
    }
    links.back() = product.pose();
    return links;
}

void Chain::differentiate(const Isometry3d& world_from_base, const VectorXd& q,
                          const VectorXd& parameters, FlangeMotion& motion, bool by_joints) const {
    walk(world_from_base, q, parameters, motion, by_joints,
         [](const Element&, const Twist&, Index) {});
}

void Chain::differentiate_twice(const Isometry3d& world_from_base, const VectorXd& q,
                                const VectorXd& parameters, FlangeMotion& motion,
                                std::vector<FlangeMotionRate>& rates) const {
    rates.resize(joints().size());
    for (FlangeMotionRate& rate : rates) {
        rate.twists.setZero(6, 6 + parameter_count());
        rate.joint_twists.setZero(6, joint_count());
    }
    TwistMatrix changes(6, joint_count());  // of the element's twist, by each joint
    const auto visit = [&](const Element& element, const Twist& twist, Index first) {
        const bool is_error = !element.parameter.empty();
        for (Index j = 0; j < joint_count(); ++j) {
            // So far motion.joint_twists holds what joint j moves up to this element.
            changes.col(j) = lie_bracket(motion.joint_twists.col(j), twist);
            FlangeMotionRate& rate = rates[static_cast<std::size_t>(j)];
            if (is_error) rate.twists.col(6 + first) = changes.col(j);
            for (const JointTerm& term : element.joints) {
                rate.joint_twists.col(term.joint) += term.coefficient * changes.col(j);
            }
        }
        if (!element.has_functions()) return;
        const Index next = element.parameter.empty() ? first : first + 1;
        add_term_rates(element, q, parameters, twist, next, changes, rates);
    };
    walk(world_from_base, q, parameters, motion, true, visit);
}

}  // namespace posewise
