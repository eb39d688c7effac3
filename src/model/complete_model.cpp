#include "complete_model.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "posewise/model/error_terms.hpp"

namespace posewise::detail {
namespace {

std::string axis_letter(Index axis) { return {static_cast<char>('x' + axis)}; }

/// "2" for joint q2, else "_name": short for the usual names, never ambiguous.
std::string suffix(const std::string& joint) {
    const bool numbered = joint.size() > 1 && joint[0] == 'q' &&
                          joint.find_first_not_of("0123456789", 1) == std::string::npos;
    return numbered ? joint.substr(1) : '_' + joint;
}

/// An axis that joints drive.
struct DrivenAxisName {
    Index joint = -1;  ///< that carries its errors; -1: it has none of its own
    int number = 1;    ///< which of that joint's axes
};

/// Whether right beside this element, on one side, joints drive another of its kind: one axis,
/// written in two elements.
bool is_one_with_next(const std::vector<Element>& elements, std::size_t k, std::ptrdiff_t step) {
    const auto is_nothing = [](const Element& element) {
        return element.joints.empty() && element.value == 0;
    };
    std::size_t i = k + static_cast<std::size_t>(step);
    while (i < elements.size() && is_nothing(elements[i])) i += static_cast<std::size_t>(step);
    return i < elements.size() && !elements[i].joints.empty() &&
           elements[i].motion == elements[k].motion && elements[i].axis == elements[k].axis;
}

/// For each element the axis whose errors follow it. One that only moves along with joints that
/// move others, too, as a mimic, is an axis of its own all the same.
std::vector<DrivenAxisName> name_axes(const Chain& chain) {
    const std::vector<Element>& elements = chain.elements();
    const std::vector<Index> owners = element_owners(chain);
    std::vector<int> counts(chain.joints().size(), 1);
    std::vector<DrivenAxisName> axes;
    for (std::size_t k = 0; k < elements.size(); ++k) {
        axes.push_back({owners[k]});
        const bool is_coupled = owners[k] < 0 && !elements[k].joints.empty();
        if (!is_coupled || is_one_with_next(elements, k, 1) || is_one_with_next(elements, k, -1)) {
            continue;
        }
        const Index joint = elements[k].joints.front().joint;
        axes.back() = {joint, ++counts[static_cast<std::size_t>(joint)]};
    }
    return axes;
}

/// "q2", of its second axis "q2_2", unless another joint has that name.
std::string axis_name(const Chain& chain, const DrivenAxisName& axis) {
    const std::string& name = chain.joint(axis.joint).name;
    if (axis.number == 1) return name;
    std::string numbered = fmt::format("{}_{}", name, axis.number);
    const auto is_taken = [&] {
        return std::ranges::find(chain.joints(), numbered, &Joint::name) != chain.joints().end();
    };
    while (is_taken()) numbered += '_';
    return numbered;
}

/// with_gains() of the axes for which `is_gained(element, owner)` says so.
template <typename IsGained>
Chain add_gains(const Chain& chain, const IsGained& is_gained) {
    const std::vector<Index> owners = element_owners(chain);
    const std::vector<DrivenAxisName> axes = name_axes(chain);
    std::vector<Element> elements = chain.elements();
    for (std::size_t k = 0; k < axes.size(); ++k) {
        if (axes[k].joint < 0 || !is_gained(elements[k], owners[k])) continue;
        JointFunction amount;
        for (const JointTerm& term : elements[k].joints) {
            if (owners[k] >= 0 && term.joint != owners[k]) continue;
            const Joint& joint = chain.joint(term.joint);
            amount.joints.push_back(term);
            amount.phase -= term.coefficient * (joint.lower + joint.upper) / 2;
        }
        const bool turns = elements[k].motion == Motion::Rotation;
        const std::string name = axis_name(chain, axes[k]) + (turns ? ".gain" : ".scale");
        const bool is_there = std::ranges::find(elements[k].terms, name, &ErrorTerm::parameter) !=
                              elements[k].terms.end();
        if (!is_there) elements[k].terms.push_back({name, std::move(amount), TermKind::Gain});
    }
    return chain.with_elements(std::move(elements));
}

}  // namespace

Chain complete_model(const Chain& chain) {
    std::vector<Element> elements;
    const std::vector<DrivenAxisName> axes = name_axes(chain);
    for (std::size_t k = 0; k < axes.size(); ++k) {
        Element element = chain.elements()[k];
        element.parameter.clear();
        if (axes[k].joint < 0) {
            elements.push_back(element);
            continue;
        }
        const std::string name = axis_name(chain, axes[k]);
        element.parameter = "d" + (name[0] == 'q' ? name : "_" + name);
        elements.push_back(element);
        for (const Motion motion : {Motion::Translation, Motion::Rotation}) {
            for (Index axis = 0; axis < 3; ++axis) {
                if (axis == static_cast<Index>(element.axis)) continue;
                const std::string letter = motion == Motion::Translation ? "T" : "R";
                elements.push_back({motion,
                                    static_cast<Axis>(axis),
                                    0.0,
                                    {},
                                    letter + axis_letter(axis) + suffix(name)});
            }
        }
    }
    return chain.with_elements(std::move(elements));
}

Chain full_model(const Chain& chain, const Vector3d& gravity) {
    const Chain bending = with_harmonics(with_torque_shapes(chain, gravity), {1, 2});
    return complete_model(add_gains(bending, [](const Element& element, Index owner) {
        return element.motion == Motion::Translation || owner < 0;
    }));
}

}  // namespace posewise::detail

namespace posewise {

Chain with_gains(const Chain& chain, const std::vector<Index>& joints) {
    return detail::add_gains(chain, [&](const Element& element, Index) {
        return joints.empty() || std::ranges::any_of(element.joints, [&](const JointTerm& term) {
                   return std::ranges::find(joints, term.joint) != joints.end();
               });
    });
}

}  // namespace posewise
