#include "posewise/model/chain.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "posewise/core/errors.hpp"
#include "posewise/model/gravity_torque.hpp"

namespace posewise {
namespace {

/// world_from_base * E_1 * ... * E_k, kept as rotation and position because an elementary
/// transform touches only two columns of the one or one combination of the other.
struct RunningProduct {
    Matrix3d R;
    Vector3d p;

    void append(Motion motion, Axis axis, double amount) {
        const auto a = static_cast<Index>(axis);
        if (motion == Motion::Translation) {
            p += amount * R.col(a);
            return;
        }
        const double c = std::cos(amount);
        const double s = std::sin(amount);
        const Index i = (a + 1) % 3;
        const Index j = (a + 2) % 3;
        const Vector3d column = R.col(i);
        R.col(i) = c * column + s * R.col(j);
        R.col(j) = c * R.col(j) - s * column;
    }

    /// How what follows moves by a further amount along or about the axis.
    Twist twist(Motion motion, Axis axis) const {
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

double sum_of(double start, const std::vector<JointTerm>& joints, const VectorXd& q) {
    for (const JointTerm& term : joints) start += term.coefficient * q[term.joint];
    return start;
}

/// A joint function and its derivatives by u.
struct FunctionValue {
    double value, slope, curvature;
};

FunctionValue evaluate(const JointFunction& function, const VectorXd& q) {
    if (function.torque != nullptr) return {function.torque->evaluate(q).value, 0, 0};
    const double u = sum_of(function.phase, function.joints, q);
    if (function.shape == JointFunction::Shape::Linear) return {u, 1, 0};
    const double sine = std::sin(u);
    return {sine, std::cos(u), -sine};
}

/// E's amount; `next` is the number of the element's first error parameter, then behind its last.
double amount_of(const Element& element, const VectorXd& q, const VectorXd& parameters,
                 Index& next) {
    double amount = sum_of(element.value, element.joints, q);
    if (!element.parameter.empty()) amount += parameters[next++];
    for (const ErrorTerm& term : element.terms) {
        amount += parameters[next++] * evaluate(term.function, q).value;
    }
    return amount;
}

void check_unique(const std::set<std::string>& seen, const std::string& name, const char* what) {
    if (seen.count(name) != 0) throw InputError(std::string(what) + " '" + name + "' occurs twice");
}

void check_joint(const Joint& joint) {
    if (!std::isfinite(joint.lower) || !std::isfinite(joint.upper) || joint.lower >= joint.upper) {
        throw InputError("joint '" + joint.name + "' has limits " + std::to_string(joint.lower) +
                         " to " + std::to_string(joint.upper) +
                         " (rad or m): must be finite, the lower one first");
    }
}

/// `subject` is "element 3 of the chain" or one of its terms.
void check_sum(const std::string& subject, double start, const std::vector<JointTerm>& joints,
               Index joint_count) {
    const auto fail = [&](const std::string& what) { throw InputError(subject + ' ' + what); };
    if (!std::isfinite(start)) fail("has a value that is not a finite number");
    for (const JointTerm& term : joints) {
        if (term.joint < 0 || term.joint >= joint_count) {
            fail("is driven by joint index " + std::to_string(term.joint) + ", the robot has " +
                 std::to_string(joint_count) + " joints");
        }
        if (!std::isfinite(term.coefficient) || term.coefficient == 0) {
            fail("has a joint coefficient that is zero or not a finite number");
        }
    }
}

/// Terms may depend on `input_count` numbers: joints and measured torques.
void check_element(const Element& element, std::size_t number, Index joint_count,
                   Index input_count) {
    const std::string subject = "element " + std::to_string(number + 1) + " of the chain";
    check_sum(subject, element.value, element.joints, joint_count);
    for (const ErrorTerm& term : element.terms) {
        if (term.parameter.empty()) throw InputError(subject + " has an error term without name");
        const std::string its_term = "term '" + term.parameter + "' of " + subject;
        const bool is_torque = term.function.shape == JointFunction::Shape::Torque;
        if (is_torque != (term.function.torque != nullptr)) {
            throw InputError(its_term + " has the shape of a torque without one, or the reverse");
        }
        if (is_torque != term.function.joints.empty()) {
            throw InputError(its_term +
                             (is_torque ? " is a torque of joints" : " depends on no joint"));
        }
        check_sum(its_term, term.function.phase, term.function.joints, input_count);
    }
}

/// What the terms of an element, error parameters `next` on, add to `motion`; returns what they add
/// to its amount. Out of line, as add_term_rates() is, so that elements without terms stay fast.
[[gnu::noinline]] double add_terms(const Element& element, const VectorXd& q,
                                   const VectorXd& parameters, const Twist& twist, Index& next,
                                   FlangeMotion& motion) {
    double amount = 0;
    for (const ErrorTerm& term : element.terms) {
        const double pi = parameters[next];
        double value = 0;
        if (term.function.torque != nullptr) {
            const TorqueShare share = term.function.torque->evaluate(q);
            value = share.value;
            motion.joint_twists += pi * twist * share.gradient.transpose();
        } else {
            const FunctionValue f = evaluate(term.function, q);
            value = f.value;
            for (const JointTerm& by : term.function.joints) {
                if (by.joint >= motion.joint_twists.cols()) continue;  // a measured torque
                motion.joint_twists.col(by.joint) += pi * f.slope * by.coefficient * twist;
            }
        }
        motion.twists.col(6 + next++) = value * twist;
        amount += pi * value;
    }
    return amount;
}

/// What a term adds to the rates by joint j of its element's twist, which changes by `change`:
/// pi df/dq_i in the column of joint i.
void add_term_rate(const JointFunction& function, const FunctionValue& f, double pi,
                   const Twist& twist, const Twist& change, Index j, Index k,
                   FlangeMotionRate& rate) {
    double du_dqj = 0;
    for (const JointTerm& by : function.joints) {
        if (by.joint == j) du_dqj += by.coefficient;
    }
    rate.twists.col(6 + k) = f.value * change + f.slope * du_dqj * twist;
    for (const JointTerm& by : function.joints) {
        if (by.joint >= rate.joint_twists.cols()) continue;  // a measured torque
        rate.joint_twists.col(by.joint) +=
            pi * by.coefficient * (f.slope * change + f.curvature * du_dqj * twist);
    }
}

/// What the terms of an element, error parameters k on, add to the rates: the element's twist,
/// which joint j changes by its Lie bracket, is multiplied by f(q) in the term's column and by pi
/// df/dq_i in that of joint i.
[[gnu::noinline]] void add_term_rates(const Element& element, const VectorXd& q,
                                      const VectorXd& parameters, const Twist& twist, Index k,
                                      const TwistMatrix& joint_twists,
                                      std::vector<FlangeMotionRate>& rates) {
    for (const ErrorTerm& term : element.terms) {
        const bool is_torque = term.function.torque != nullptr;
        const TorqueShare share =
            is_torque ? term.function.torque->evaluate_twice(q) : TorqueShare{};
        const FunctionValue f = is_torque ? FunctionValue{} : evaluate(term.function, q);
        for (Index j = 0; j < joint_twists.cols(); ++j) {
            const Twist change = lie_bracket(joint_twists.col(j), twist);
            FlangeMotionRate& rate = rates[static_cast<std::size_t>(j)];
            if (!is_torque) {
                add_term_rate(term.function, f, parameters[k], twist, change, j, k, rate);
                continue;
            }
            rate.twists.col(6 + k) = share.value * change + share.gradient[j] * twist;
            rate.joint_twists += parameters[k] * (change * share.gradient.transpose() +
                                                  twist * share.hessian.row(j));
        }
        ++k;
    }
}

}  // namespace

Chain::Chain(std::vector<Joint> joints, std::vector<Element> elements,
             std::vector<MeasuredTorque> torques)
    : joints_(std::move(joints)), elements_(std::move(elements)), torques_(std::move(torques)) {
    std::set<std::string> names;
    for (const Joint& joint : joints_) {
        check_unique(names, joint.name, "joint");
        names.insert(joint.name);
        check_joint(joint);
    }
    std::vector<std::optional<Motion>> driven(joints_.size());
    for (std::size_t k = 0; k < elements_.size(); ++k) {
        const Element& element = elements_[k];
        check_element(element, k, joint_count(), configuration_size());
        for (const JointTerm& term : element.joints) {
            auto& motion = driven[static_cast<std::size_t>(term.joint)];
            if (motion && *motion != element.motion) {
                throw InputError("joint '" + joints_[static_cast<std::size_t>(term.joint)].name +
                                 "' drives a rotation and a translation; it can drive only one "
                                 "kind, since its unit is either rad or m");
            }
            motion = element.motion;
        }
        const auto add_parameter = [&](const std::string& name, Index term) {
            check_unique(names, name, "parameter");
            names.insert(name);
            parameter_places_.push_back({static_cast<Index>(k), term});
        };
        if (!element.parameter.empty()) add_parameter(element.parameter, -1);
        for (std::size_t i = 0; i < element.terms.size(); ++i) {
            add_parameter(element.terms[i].parameter, static_cast<Index>(i));
        }
    }
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        if (!driven[j]) throw InputError("joint '" + joints_[j].name + "' drives no element");
    }
    check_torques();
}

void Chain::check_torques() const {
    std::set<Index> seen;
    for (const MeasuredTorque& torque : torques_) {
        if (torque.joint < 0 || torque.joint >= joint_count()) {
            throw InputError("a measured torque is of joint index " + std::to_string(torque.joint) +
                             ", the robot has " + std::to_string(joint_count()) + " joints");
        }
        const std::string subject =
            "the measured torque of joint '" + joints_[static_cast<std::size_t>(torque.joint)].name;
        if (joint_motion(torque.joint) != Motion::Rotation) {
            throw InputError(subject + "' is of one that slides; must be of one that turns");
        }
        if (!std::isfinite(torque.largest) || torque.largest <= 0) {
            throw InputError(subject + "' has no positive and finite largest value");
        }
        if (!seen.insert(torque.joint).second) throw InputError(subject + "' occurs twice");
    }
}

Chain Chain::with_elements(std::vector<Element> elements) const {
    return Chain(joints_, std::move(elements), torques_);
}

Motion Chain::joint_motion(Index joint) const {
    const auto drives = [joint](const Element& element) {
        return std::any_of(element.joints.begin(), element.joints.end(),
                           [joint](const JointTerm& term) { return term.joint == joint; });
    };
    return std::find_if(elements_.begin(), elements_.end(), drives)->motion;
}

const Element& Chain::parameter_element(Index parameter) const {
    const Place& place = parameter_places_[static_cast<std::size_t>(parameter)];
    return elements_[static_cast<std::size_t>(place.element)];
}

const ErrorTerm* Chain::parameter_term(Index parameter) const {
    const Index term = parameter_places_[static_cast<std::size_t>(parameter)].term;
    return term < 0 ? nullptr : &parameter_element(parameter).terms[static_cast<std::size_t>(term)];
}

std::vector<std::string> Chain::parameter_names() const {
    std::vector<std::string> names;
    for (Index k = 0; k < parameter_count(); ++k) {
        const ErrorTerm* const term = parameter_term(k);
        names.push_back(term == nullptr ? parameter_element(k).parameter : term->parameter);
    }
    return names;
}

void Chain::check_configuration(const VectorXd& q) const {
    if (q.size() != configuration_size()) {
        const std::string torques =
            torques_.empty() ? "" : " and " + std::to_string(torques_.size()) + " measured torques";
        throw InputError("configuration has " + std::to_string(q.size()) +
                         (torques_.empty() ? " joint values" : " values") + ", the robot has " +
                         std::to_string(joint_count()) + " joints" + torques);
    }
    for (Index k = 0; k < q.size(); ++k) {
        if (std::isfinite(q[k])) continue;
        const bool is_joint = k < joint_count();
        const Index joint =
            is_joint ? k : torques_[static_cast<std::size_t>(k - joint_count())].joint;
        throw InputError((is_joint ? "joint '" : "the torque of joint '") +
                         joints_[static_cast<std::size_t>(joint)].name +
                         "' has a value that is not a finite number");
    }
}

Isometry3d Chain::base_from_flange(const VectorXd& q, const VectorXd& parameters) const {
    RunningProduct product{Matrix3d::Identity(), Vector3d::Zero()};
    Index k = 0;
    for (const Element& element : elements_) {
        product.append(element.motion, element.axis, amount_of(element, q, parameters, k));
    }
    return product.pose();
}

/// One pass over the elements. After an element that moves something has added its twist to its
/// columns of `motion`, visit(element, twist, parameter) is called with the number of its first
/// error parameter.
template <typename Visit>
void Chain::walk(const Isometry3d& world_from_base, const VectorXd& q, const VectorXd& parameters,
                 FlangeMotion& motion, const Visit& visit) const {
    motion.twists.resize(6, 6 + parameter_count());
    motion.joint_twists.setZero(6, joint_count());
    const Vector3d base = world_from_base.translation();
    for (Index axis = 0; axis < 3; ++axis) {
        const Vector3d unit = Vector3d::Unit(axis);
        motion.twists.col(axis) << Vector3d::Zero(), unit;
        motion.twists.col(3 + axis) << unit, base.cross(unit);
    }
    RunningProduct product{world_from_base.linear(), base};
    Index next = 0;
    for (const Element& element : elements_) {
        const Index first = next;
        double amount = sum_of(element.value, element.joints, q);
        if (!element.parameter.empty()) amount += parameters[next++];
        if (next > first || !element.joints.empty() || !element.terms.empty()) {
            const Twist twist = product.twist(element.motion, element.axis);
            if (next > first) motion.twists.col(6 + first) = twist;
            for (const JointTerm& term : element.joints) {
                motion.joint_twists.col(term.joint) += term.coefficient * twist;
            }
            if (!element.terms.empty()) {
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
    std::vector<Isometry3d> links(joints_.size() + 2, Isometry3d::Identity());
    std::vector<bool> is_found(joints_.size(), false);
    RunningProduct product{Matrix3d::Identity(), Vector3d::Zero()};
    Index k = 0;
    for (const Element& element : elements_) {
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
                          const VectorXd& parameters, FlangeMotion& motion) const {
    walk(world_from_base, q, parameters, motion, [](const Element&, const Twist&, Index) {});
}

void Chain::differentiate_twice(const Isometry3d& world_from_base, const VectorXd& q,
                                const VectorXd& parameters, FlangeMotion& motion,
                                std::vector<FlangeMotionRate>& rates) const {
    rates.resize(joints_.size());
    for (FlangeMotionRate& rate : rates) {
        rate.twists.setZero(6, 6 + parameter_count());
        rate.joint_twists.setZero(6, joint_count());
    }
    const auto visit = [&](const Element& element, const Twist& twist, Index first) {
        const bool is_error = !element.parameter.empty();
        for (Index j = 0; j < joint_count(); ++j) {
            // So far motion.joint_twists holds what joint j moves up to this element.
            const Twist change = lie_bracket(motion.joint_twists.col(j), twist);
            FlangeMotionRate& rate = rates[static_cast<std::size_t>(j)];
            if (is_error) rate.twists.col(6 + first) = change;
            for (const JointTerm& term : element.joints) {
                rate.joint_twists.col(term.joint) += term.coefficient * change;
            }
        }
        if (element.terms.empty()) return;
        const Index next = element.parameter.empty() ? first : first + 1;
        add_term_rates(element, q, parameters, twist, next, motion.joint_twists, rates);
    };
    walk(world_from_base, q, parameters, motion, visit);
}

std::vector<Index> element_owners(const Chain& chain) {
    std::vector<Index> owners;
    std::vector<bool> seen(chain.joints().size(), false);
    for (const Element& element : chain.elements()) {
        Index owner = -1;
        for (const JointTerm& term : element.joints) {
            if (owner < 0 && !seen[static_cast<std::size_t>(term.joint)]) owner = term.joint;
        }
        if (owner >= 0) seen[static_cast<std::size_t>(owner)] = true;
        owners.push_back(owner);
    }
    return owners;
}

Chain without_parameters(const Chain& chain) {
    std::vector<Element> elements = chain.elements();
    for (Element& element : elements) {
        element.parameter.clear();
        element.terms.clear();
    }
    return chain.with_elements(std::move(elements));
}

}  // namespace posewise
