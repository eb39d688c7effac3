#pragma once

#include "core/elementary.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"

/// How far an element moves at a configuration.
namespace posewise::detail {

inline double sum_of(double start, const std::vector<JointTerm>& joints, const VectorXd& q) {
    for (const JointTerm& term : joints) start += term.coefficient * q[term.joint];
    return start;
}

/// What a function of shape Torque multiplies its torque by: u, or 1 if it depends on no joint.
inline double torque_factor(const JointFunction& function, const VectorXd& q) {
    return function.joints.empty() ? 1 : sum_of(function.phase, function.joints, q);
}

/// A joint function and its derivatives by u.
struct FunctionValue {
    double value, slope, curvature;
};

inline FunctionValue evaluate(const JointFunction& function, const VectorXd& q) {
    if (function.torque != nullptr) {
        return {function.torque->value(q) * torque_factor(function, q), 0, 0};
    }
    const double u = sum_of(function.phase, function.joints, q);
    if (function.shape == JointFunction::Shape::Linear) return {u, 1, 0};
    const auto [sine, cosine] = sine_and_cosine(u);
    return {sine, cosine, -sine};
}

/// E's amount; `next` is the number of the element's first error parameter, then after its last.
inline double amount_of(const Element& element, const VectorXd& q, const VectorXd& parameters,
                        Index& next) {
    double amount = sum_of(element.value, element.joints, q);
    if (!element.parameter.empty()) amount += parameters[next++];
    for (const ErrorTerm& term : element.terms) {
        amount += parameters[next++] * evaluate(term.function, q).value;
    }
    for (const KnownTerm& term : element.known_terms) {
        amount += term.coefficient * evaluate(term.function, q).value;
    }
    return amount;
}

}  // namespace posewise::detail
