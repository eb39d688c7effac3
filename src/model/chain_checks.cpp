#include "chain_checks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <set>

#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

void add_unique(std::set<std::string>& names, const std::string& name, const char* what) {
    if (names.insert(name).second) return;
    throw InputError(std::string(what) + " '" + name + "' occurs twice");
}

void check_joint(const Joint& joint) {
    if (!std::isfinite(joint.lower) || !std::isfinite(joint.upper) || joint.lower >= joint.upper) {
        throw InputError(fmt::format(
            "joint '{}' has limits {:g} to {:g} (rad or m): must be finite, the lower one first",
            joint.name, joint.lower, joint.upper));
    }
    if (!std::isfinite(joint.pitch) || joint.pitch < 0) {
        throw InputError(fmt::format("joint '{}' has a pitch of {:g} m: must be positive",
                                     joint.name, joint.pitch));
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
        if (!is_torque && term.function.joints.empty()) {
            throw InputError(its_term + " depends on no joint");
        }
        check_sum(its_term, term.function.phase, term.function.joints, input_count);
    }
    for (const KnownTerm& term : element.known_terms) {
        check_sum("a known term of " + subject, term.coefficient, term.function.joints,
                  input_count);
    }
}

}  // namespace

void check_joints(const std::vector<Joint>& joints) {
    std::set<std::string> names;
    for (const Joint& joint : joints) {
        add_unique(names, joint.name, "joint");
        check_joint(joint);
    }
}

void check_elements(const std::vector<Element>& elements, const std::vector<Joint>& joints,
                    Index input_count) {
    std::set<std::string> names;
    for (const Joint& joint : joints) names.insert(joint.name);
    const auto joint_count = static_cast<Index>(joints.size());
    for (std::size_t k = 0; k < elements.size(); ++k) {
        const Element& element = elements[k];
        check_element(element, k, joint_count, input_count);
        if (!element.parameter.empty()) add_unique(names, element.parameter, "parameter");
        for (const ErrorTerm& term : element.terms) {
            add_unique(names, term.parameter, "parameter");
        }
    }
}

std::vector<Motion> find_motions(const std::vector<Joint>& joints,
                                 const std::vector<Element>& elements) {
    std::vector<std::optional<Motion>> driven(joints.size());
    for (const Element& element : elements) {
        for (const JointTerm& term : element.joints) {
            const auto joint = static_cast<std::size_t>(term.joint);
            if (driven[joint].value_or(element.motion) != element.motion) {
                throw InputError("joint '" + joints[joint].name +
                                 "' drives a rotation and a translation; it can drive only one "
                                 "kind, since its unit is either rad or m");
            }
            driven[joint] = element.motion;
        }
    }
    std::vector<Motion> motions;
    for (std::size_t j = 0; j < joints.size(); ++j) {
        if (!driven[j]) throw InputError("joint '" + joints[j].name + "' drives no element");
        if (*driven[j] == Motion::Rotation && joints[j].pitch != 0) {
            throw InputError("joint '" + joints[j].name +
                             "' turns; only one that slides has a pitch");
        }
        motions.push_back(*driven[j]);
    }
    return motions;
}

void check_direction(const Vector3d& direction) {
    if (!direction.allFinite() || direction.isZero(0)) {
        throw InputError("direction of gravity must be finite and not zero");
    }
}

void check_torques(const std::vector<MeasuredTorque>& torques, const std::vector<Joint>& joints) {
    const auto joint_count = static_cast<Index>(joints.size());
    std::set<Index> seen;
    for (const MeasuredTorque& torque : torques) {
        if (torque.joint < 0 || torque.joint >= joint_count) {
            throw InputError("a measured torque is of joint index " + std::to_string(torque.joint) +
                             ", the robot has " + std::to_string(joint_count) + " joints");
        }
        const Joint& joint = joints[static_cast<std::size_t>(torque.joint)];
        const std::string subject = "the measured torque of joint '" + joint.name;
        if (joint.motion != Motion::Rotation) {
            throw InputError(subject + "' is of one that slides; must be of one that turns");
        }
        if (!std::isfinite(torque.largest) || torque.largest <= 0) {
            throw InputError(subject + "' has no positive and finite largest value");
        }
        if (!seen.insert(torque.joint).second) throw InputError(subject + "' occurs twice");
    }
}

}  // namespace posewise::detail
