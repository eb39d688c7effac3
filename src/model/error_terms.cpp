#include "posewise/model/error_terms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "chain_checks.hpp"
#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

constexpr double parallel_tolerance = std::numbers::pi / 180;
constexpr double full_turn = 2 * std::numbers::pi;

const std::string& joint_name(const Chain& chain, Index joint) {
    return chain.joints()[static_cast<std::size_t>(joint)].name;
}

std::string compliance_name(const Chain& chain, Index joint) {
    return joint_name(chain, joint) + ".compliance";
}

bool is_wanted(const std::vector<Index>& joints, Index joint) {
    return joints.empty() || std::find(joints.begin(), joints.end(), joint) != joints.end();
}

/// A sine and a cosine of the sum of `joints`, as errors of an element. Their names begin with
/// `owner`.
void add_waves(const Chain& chain, const std::string& owner, const std::vector<JointTerm>& joints,
               TermKind kind, Element& element) {
    for (const double phase : {0.0, std::numbers::pi / 2}) {
        const JointFunction wave{JointFunction::Shape::Sine, joints, phase};
        const std::string name = owner + '.' + describe_function(wave, chain.joints());
        const auto is_same = [&](const ErrorTerm& term) { return term.parameter == name; };
        if (std::none_of(element.terms.begin(), element.terms.end(), is_same)) {
            element.terms.push_back({name, wave, kind});
        }
    }
}

void check_joints(const Chain& chain, const std::vector<Index>& joints) {
    for (const Index joint : joints) {
        if (joint < 0 || joint >= chain.joint_count()) {
            throw InputError("joint index " + std::to_string(joint) + " must be below " +
                             std::to_string(chain.joint_count()));
        }
    }
}

/// How far the joint turns by its value, or of a slide its drive; 0: that is not known.
double turn_rate(const Joint& joint) {
    if (joint.motion == Motion::Rotation) return 1;
    return joint.pitch > 0 ? full_turn / joint.pitch : 0;
}

bool does_turn(const Joint& joint) { return joint.motion == Motion::Rotation; }

/// Throws InputError unless `is_periodic(joint)` holds for all of `joints` and all orders are
/// positive and finite.
template <typename IsPeriodic>
void check_periodic(const Chain& chain, const std::vector<double>& orders,
                    const std::vector<Index>& joints, const IsPeriodic& is_periodic,
                    const char* need) {
    check_joints(chain, joints);
    for (const double order : orders) {
        if (!std::isfinite(order) || order <= 0) {
            throw InputError("order " + std::to_string(order) + " of a harmonic must be positive");
        }
    }
    for (const Index joint : joints) {
        if (is_periodic(chain.joint(joint))) continue;
        throw InputError("joint '" + joint_name(chain, joint) + "' slides; " + need);
    }
}

/// What each driven element turns about (zero: it slides) or 0 0 0 for a fixed one; in the base
/// frame, all joints at zero.
std::vector<Vector3d> axes_at_zero(const Chain& chain) {
    std::vector<Element> elements = without_parameters(chain).elements();
    for (std::size_t k = 0; k < elements.size(); ++k) {
        elements[k].parameter = "element " + std::to_string(k);
    }
    const Chain probe(chain.joints(), std::move(elements));
    FlangeMotion motion;
    probe.differentiate(Isometry3d::Identity(), VectorXd::Zero(probe.joint_count()),
                        VectorXd::Zero(probe.parameter_count()), motion);
    std::vector<Vector3d> axes;
    for (Index k = 0; k < probe.parameter_count(); ++k) {
        const bool is_fixed = probe.parameter_element(k).joints.empty();
        axes.push_back(is_fixed ? Vector3d::Zero() : Vector3d(motion.twists.col(6 + k).head<3>()));
    }
    return axes;
}

bool is_parallel(const Vector3d& a, const Vector3d& b) {
    return a.cross(b).norm() <= parallel_tolerance;
}

/// The elements of the run; see with_gravity_terms(). `down` has length 1.
std::vector<std::size_t> find_level_run(const std::vector<Vector3d>& axes, const Vector3d& down) {
    std::vector<std::size_t> run;
    for (std::size_t k = 0; k < axes.size(); ++k) {
        if (axes[k].isZero(0)) continue;
        if (run.empty() && is_parallel(axes[k], down)) continue;
        const bool is_level = std::abs(axes[k].dot(down)) <= parallel_tolerance;
        if (!is_level || (!run.empty() && !is_parallel(axes[k], axes[run.front()]))) break;
        run.push_back(k);
    }
    return run;
}

void add_to(std::vector<JointTerm>& sum, const std::vector<JointTerm>& joints, double sign) {
    for (const JointTerm& term : joints) {
        const auto same = std::find_if(sum.begin(), sum.end(),
                                       [&](const JointTerm& t) { return t.joint == term.joint; });
        if (same == sum.end()) {
            sum.push_back({term.joint, sign * term.coefficient});
        } else {
            same->coefficient += sign * term.coefficient;
        }
    }
    std::erase_if(sum, [](const JointTerm& term) { return term.coefficient == 0; });
}

/// Angle about the run's axis, positive with its first joint, of what each of its elements carries.
std::vector<std::vector<JointTerm>> partial_sums(const Chain& chain,
                                                 const std::vector<Vector3d>& axes,
                                                 const std::vector<std::size_t>& run) {
    std::vector<std::vector<JointTerm>> sums;
    std::vector<JointTerm> sum;
    const double first = chain.elements()[run.front()].joints.front().coefficient;
    const Vector3d axis = (first < 0 ? -1 : 1) * axes[run.front()];
    for (const std::size_t k : run) {
        add_to(sum, chain.elements()[k].joints, axes[k].dot(axis) < 0 ? -1 : 1);
        sums.push_back(sum);
    }
    return sums;
}

bool does_nothing(const Element& element) {
    return element.value == 0 && element.joints.empty() && element.parameter.empty();
}

/// Whether one element takes back what the other does, as beside the middle of a slide that bends.
bool do_nothing(const Element& element, const Element& next) {
    if (element.motion != next.motion || element.axis != next.axis) return false;
    std::vector<JointTerm> joints = element.joints;
    add_to(joints, next.joints, 1);
    return element.value + next.value == 0 && joints.empty() && element.parameter.empty() &&
           next.parameter.empty();
}

}  // namespace

std::string describe_function(const JointFunction& function, const std::vector<Joint>& joints) {
    const bool is_sine = function.shape == JointFunction::Shape::Sine;
    const bool is_cosine = is_sine && function.phase == std::numbers::pi / 2;
    std::string sum;
    for (const JointTerm& term : function.joints) {
        if (term.coefficient < 0) sum += '-';
        if (term.coefficient > 0 && !sum.empty()) sum += '+';
        const Joint& joint = joints[static_cast<std::size_t>(term.joint)];
        const bool in_turns = is_sine && joint.pitch > 0;
        const std::string size = fmt::format(
            "{:.9g}", std::abs(term.coefficient) * (in_turns ? joint.pitch / full_turn : 1));
        if (size != "1") sum += size;
        sum += joint.name;
    }
    if (!is_cosine && function.phase != 0) sum += fmt::format("{:+.6g}", function.phase);
    return (is_cosine ? "cos(" : is_sine ? "sin(" : "lin(") + sum + ')';
}

Chain with_gravity_terms(const Chain& chain, const Vector3d& direction,
                         const std::vector<Index>& joints) {
    check_joints(chain, joints);
    detail::check_direction(direction);
    const std::vector<Vector3d> axes = axes_at_zero(chain);
    const std::vector<std::size_t> run = find_level_run(axes, direction.stableNormalized());
    if (run.empty()) {
        throw InputError(
            "no joint turns about an axis that stays perpendicular to gravity: there are no "
            "gravity terms");
    }
    const auto sums = partial_sums(chain, axes, run);
    const std::vector<Index> owners = element_owners(chain);
    std::vector<Element> elements = chain.elements();
    std::vector<Index> level;
    for (std::size_t j = 0; j < run.size(); ++j) {
        const Index owner = owners[run[j]];
        if (owner < 0 || !is_wanted(joints, owner)) continue;
        level.push_back(owner);
        for (std::size_t k = j; k < run.size(); ++k) {
            if (sums[k].empty()) continue;
            add_waves(chain, joint_name(chain, owner), sums[k], TermKind::Gravity,
                      elements[run[j]]);
        }
    }
    for (const Index joint : joints) {
        if (is_wanted(level, joint) && !level.empty()) continue;
        throw InputError("joint '" + joint_name(chain, joint) +
                         "' does not turn about an axis that stays perpendicular to gravity");
    }
    return chain.with_elements(std::move(elements));
}

Chain with_compliance(const Chain& chain, const std::vector<Load>& loads, const Vector3d& direction,
                      const std::vector<Index>& joints) {
    check_joints(chain, joints);
    detail::check_direction(direction);
    if (loads.empty()) throw InputError("no load is stated, so there is no torque of gravity");
    constexpr double standard_gravity = 9.80665;  // m/s^2
    const Vector3d gravity = standard_gravity * direction.stableNormalized();
    const std::vector<Index> owners = element_owners(chain);
    std::vector<Element> elements = chain.elements();
    for (std::size_t k = 0; k < elements.size(); ++k) {
        if (owners[k] < 0 || !is_wanted(joints, owners[k])) continue;
        auto torque = std::make_shared<const GravityTorque>(chain, k, gravity, loads);
        if (torque->varies()) {
            elements[k].terms.push_back({compliance_name(chain, owners[k]),
                                         {JointFunction::Shape::Torque, {}, 0, std::move(torque)},
                                         TermKind::Gravity});
        } else if (!joints.empty()) {
            throw InputError("the weights turn joint '" + joint_name(chain, owners[k]) +
                             "' not at all or always alike, so that its compliance has no effect");
        }
    }
    Chain result = chain.with_elements(std::move(elements));
    if (result.parameter_count() == chain.parameter_count()) {
        throw InputError("the weights turn no joint, so there are no compliances");
    }
    return result;
}

Chain with_measured_compliance(const Chain& chain, const std::vector<MeasuredTorque>& torques) {
    const std::vector<Index> owners = element_owners(chain);
    std::vector<Element> elements = chain.elements();
    for (std::size_t t = 0; t < torques.size(); ++t) {
        const auto owned = std::find(owners.begin(), owners.end(), torques[t].joint);
        if (owned == owners.end()) continue;  // the new chain tells
        const Index input = chain.joint_count() + static_cast<Index>(t);
        elements[static_cast<std::size_t>(owned - owners.begin())].terms.push_back(
            {compliance_name(chain, torques[t].joint),
             {JointFunction::Shape::Linear, {{input, 1 / torques[t].largest}}},
             TermKind::Gravity});
    }
    return Chain(chain.joints(), std::move(elements), torques);
}

std::vector<Compliance> compliances(const Chain& chain) {
    std::vector<Compliance> found;
    for (Index k = 0; k < chain.parameter_count(); ++k) {
        const ErrorTerm* const term = chain.parameter_term(k);
        if (term == nullptr) continue;
        const JointFunction& function = term->function;
        if (term->kind == TermKind::Torque) continue;
        if (function.torque != nullptr) {
            found.push_back({k, parameter_owner(chain, k), function.torque->largest()});
        } else if (function.joints.front().joint >= chain.joint_count()) {
            found.push_back(
                {k, parameter_owner(chain, k), 1 / function.joints.front().coefficient});
        }
    }
    return found;
}

Chain with_harmonics(const Chain& chain, const std::vector<double>& orders,
                     const std::vector<Index>& joints) {
    check_periodic(
        chain, orders, joints, [](const Joint& joint) { return turn_rate(joint) > 0; },
        "harmonics need its pitch, or a joint that turns");
    const std::vector<Index> owners = element_owners(chain);
    std::vector<Element> elements = chain.elements();
    for (std::size_t k = 0; k < elements.size(); ++k) {
        if (owners[k] < 0 || !is_wanted(joints, owners[k])) continue;
        const double rate = turn_rate(chain.joint(owners[k]));
        if (rate == 0) continue;
        for (const double order : orders) {
            add_waves(chain, joint_name(chain, owners[k]), {{owners[k], order * rate}},
                      TermKind::Harmonic, elements[k]);
        }
    }
    return chain.with_elements(std::move(elements));
}

Chain with_axis_tilt(const Chain& chain, const std::vector<double>& orders,
                     const std::vector<Index>& joints) {
    check_periodic(chain, orders, joints, does_turn, "tilts need one that turns");
    const std::vector<Index> owners = element_owners(chain);
    std::vector<Element> elements;
    for (std::size_t k = 0; k < owners.size(); ++k) {
        const Element& element = chain.elements()[k];
        elements.push_back(element);
        if (owners[k] < 0 || !does_turn(chain.joint(owners[k])) || !is_wanted(joints, owners[k])) {
            continue;
        }
        for (const auto& [axis, name] :
             {std::pair(Axis::X, ".Rx"), std::pair(Axis::Y, ".Ry"), std::pair(Axis::Z, ".Rz")}) {
            if (axis == element.axis) continue;
            Element tilt{Motion::Rotation, axis, 0, {}};
            for (const double order : orders) {
                add_waves(chain, joint_name(chain, owners[k]) + name, {{owners[k], order}},
                          TermKind::Tilt, tilt);
            }
            elements.push_back(std::move(tilt));
        }
    }
    return chain.with_elements(std::move(elements));
}

std::vector<std::string> active_terms(const Chain& chain, const VectorXd& parameters) {
    std::vector<std::string> names;
    for (Index k = 0; k < chain.parameter_count(); ++k) {
        const ErrorTerm* const term = chain.parameter_term(k);
        if (term != nullptr && parameters[k] != 0) names.push_back(term->parameter);
    }
    return names;
}

Chain without_terms(const Chain& chain) {
    std::vector<Element> elements;
    for (Element element : chain.elements()) {
        element.terms.clear();
        element.known_terms.clear();
        if (does_nothing(element)) continue;
        if (!elements.empty() && do_nothing(elements.back(), element)) {
            elements.pop_back();
        } else {
            elements.push_back(std::move(element));
        }
    }
    return chain.with_elements(std::move(elements));
}

}  // namespace posewise
