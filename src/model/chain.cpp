#include "posewise/model/chain.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "posewise/core/errors.hpp"

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

double drive(const Element& element, const VectorXd& q) {
    double amount = element.value;
    for (const JointTerm& term : element.joints) amount += term.coefficient * q[term.joint];
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

void check_element(const Element& element, std::size_t number, Index joint_count) {
    const auto fail = [number](const std::string& what) {
        throw InputError("element " + std::to_string(number + 1) + " of the chain " + what);
    };
    if (!std::isfinite(element.value)) fail("has a value that is not a finite number");
    for (const JointTerm& term : element.joints) {
        if (term.joint < 0 || term.joint >= joint_count) {
            fail("is driven by joint index " + std::to_string(term.joint) + ", the robot has " +
                 std::to_string(joint_count) + " joints");
        }
        if (!std::isfinite(term.coefficient) || term.coefficient == 0) {
            fail("has a joint coefficient that is zero or not a finite number");
        }
    }
}

}  // namespace

Chain::Chain(std::vector<Joint> joints, std::vector<Element> elements)
    : joints_(std::move(joints)), elements_(std::move(elements)) {
    std::set<std::string> names;
    for (const Joint& joint : joints_) {
        check_unique(names, joint.name, "joint");
        names.insert(joint.name);
        check_joint(joint);
    }
    std::vector<std::optional<Motion>> driven(joints_.size());
    for (std::size_t k = 0; k < elements_.size(); ++k) {
        const Element& element = elements_[k];
        check_element(element, k, joint_count());
        for (const JointTerm& term : element.joints) {
            auto& motion = driven[static_cast<std::size_t>(term.joint)];
            if (motion && *motion != element.motion) {
                throw InputError("joint '" + joints_[static_cast<std::size_t>(term.joint)].name +
                                 "' drives a rotation and a translation; it can drive only one "
                                 "kind, since its unit is either rad or m");
            }
            motion = element.motion;
        }
        if (!element.parameter.empty()) {
            check_unique(names, element.parameter, "parameter");
            names.insert(element.parameter);
            parameter_elements_.push_back(static_cast<Index>(k));
        }
    }
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        if (!driven[j]) throw InputError("joint '" + joints_[j].name + "' drives no element");
    }
}

Motion Chain::joint_motion(Index joint) const {
    const auto drives = [joint](const Element& element) {
        return std::any_of(element.joints.begin(), element.joints.end(),
                           [joint](const JointTerm& term) { return term.joint == joint; });
    };
    return std::find_if(elements_.begin(), elements_.end(), drives)->motion;
}

const Element& Chain::parameter_element(Index parameter) const {
    return elements_[static_cast<std::size_t>(
        parameter_elements_[static_cast<std::size_t>(parameter)])];
}

std::vector<std::string> Chain::parameter_names() const {
    std::vector<std::string> names;
    for (Index k = 0; k < parameter_count(); ++k) names.push_back(parameter_element(k).parameter);
    return names;
}

void Chain::check_configuration(const VectorXd& q) const {
    if (q.size() != joint_count()) {
        throw InputError("configuration has " + std::to_string(q.size()) +
                         " joint values, the robot has " + std::to_string(joint_count()) +
                         " joints");
    }
    for (Index j = 0; j < q.size(); ++j) {
        if (!std::isfinite(q[j])) {
            throw InputError("joint '" + joints_[static_cast<std::size_t>(j)].name +
                             "' has a value that is not a finite number");
        }
    }
}

Isometry3d Chain::base_from_flange(const VectorXd& q, const VectorXd& parameters) const {
    RunningProduct product{Matrix3d::Identity(), Vector3d::Zero()};
    Index k = 0;
    for (const Element& element : elements_) {
        double amount = drive(element, q);
        if (!element.parameter.empty()) amount += parameters[k++];
        product.append(element.motion, element.axis, amount);
    }
    return product.pose();
}

/// One pass over the elements. After an element that moves something has added its twist to its
/// columns of `motion`, visit(element, twist, column) is called; the column is that of its error
/// parameter, or -1.
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
    Index next_column = 6;
    for (const Element& element : elements_) {
        double amount = drive(element, q);
        const Index column = element.parameter.empty() ? -1 : next_column++;
        if (column >= 0) amount += parameters[column - 6];
        if (column >= 0 || !element.joints.empty()) {
            const Twist twist = product.twist(element.motion, element.axis);
            if (column >= 0) motion.twists.col(column) = twist;
            for (const JointTerm& term : element.joints) {
                motion.joint_twists.col(term.joint) += term.coefficient * twist;
            }
            visit(element, twist, column);
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
        double amount = drive(element, q);
        if (!element.parameter.empty()) amount += parameters[k++];
        product.append(element.motion, element.axis, amount);
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
    const auto visit = [&](const Element& element, const Twist& twist, Index column) {
        for (Index j = 0; j < joint_count(); ++j) {
            // So far motion.joint_twists holds what joint j moves up to this element.
            const Twist change = lie_bracket(motion.joint_twists.col(j), twist);
            FlangeMotionRate& rate = rates[static_cast<std::size_t>(j)];
            if (column >= 0) rate.twists.col(column) = change;
            for (const JointTerm& term : element.joints) {
                rate.joint_twists.col(term.joint) += term.coefficient * change;
            }
        }
    };
    walk(world_from_base, q, parameters, motion, visit);
}

Chain without_parameters(const Chain& chain) {
    std::vector<Element> elements = chain.elements();
    for (Element& element : elements) element.parameter.clear();
    return Chain(chain.joints(), std::move(elements));
}

}  // namespace posewise
