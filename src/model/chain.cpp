#include "posewise/model/chain.hpp"

#include <cmath>

#include "chain_checks.hpp"
#include "posewise/core/errors.hpp"

namespace posewise {

Chain::Chain(std::vector<Joint> joints, std::vector<Element> elements,
             std::vector<MeasuredTorque> torques) {
    Parts parts{std::move(joints), std::move(elements), std::move(torques), {}};
    const auto size = static_cast<Index>(parts.joints.size() + parts.torques.size());
    detail::check_joints(parts.joints);
    detail::check_elements(parts.elements, parts.joints, size);
    const std::vector<Motion> motions = detail::find_motions(parts.joints, parts.elements);
    for (std::size_t j = 0; j < motions.size(); ++j) parts.joints[j].motion = motions[j];
    detail::check_torques(parts.torques, parts.joints);
    for (std::size_t k = 0; k < parts.elements.size(); ++k) {
        const auto element = static_cast<Index>(k);
        if (!parts.elements[k].parameter.empty()) parts.parameter_places.push_back({element, -1});
        const auto terms = static_cast<Index>(parts.elements[k].terms.size());
        for (Index i = 0; i < terms; ++i) parts.parameter_places.push_back({element, i});
    }
    parts_ = std::make_shared<Parts>(std::move(parts));
}

Chain Chain::with_elements(std::vector<Element> elements) const {
    return Chain(joints(), std::move(elements), torques());
}

const Element& Chain::parameter_element(Index parameter) const {
    const Place& place = parts_->parameter_places[static_cast<std::size_t>(parameter)];
    return elements()[static_cast<std::size_t>(place.element)];
}

const ErrorTerm* Chain::parameter_term(Index parameter) const {
    const Index term = parts_->parameter_places[static_cast<std::size_t>(parameter)].term;
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
        const std::string and_torques =
            torques().empty() ? ""
                              : " and " + std::to_string(torques().size()) + " measured torques";
        throw InputError("configuration has " + std::to_string(q.size()) +
                         (torques().empty() ? " joint values" : " values") + ", the robot has " +
                         std::to_string(joint_count()) + " joints" + and_torques);
    }
    for (Index k = 0; k < q.size(); ++k) {
        if (std::isfinite(q[k])) continue;
        const bool is_joint = k < joint_count();
        const Index joint =
            is_joint ? k : torques()[static_cast<std::size_t>(k - joint_count())].joint;
        throw InputError((is_joint ? "joint '" : "the torque of joint '") +
                         joints()[static_cast<std::size_t>(joint)].name +
                         "' has a value that is not a finite number");
    }
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

Index parameter_owner(const Chain& chain, Index parameter) {
    const auto element = &chain.parameter_element(parameter) - chain.elements().data();
    return element_owners(chain)[static_cast<std::size_t>(element)];
}

std::string transform_name(const Element& element) {
    return {element.motion == Motion::Rotation ? 'R' : 'T',
            "xyz"[static_cast<std::size_t>(element.axis)]};
}

Chain without_parameters(const Chain& chain) {
    std::vector<Element> elements;
    for (const Element& element : chain.elements()) {
        elements.push_back({element.motion, element.axis, element.value, element.joints});
        elements.back().known_terms = element.known_terms;
    }
    return chain.with_elements(std::move(elements));
}

Chain with_known_errors(const Chain& chain, const VectorXd& values,
                        const std::vector<bool>& is_known) {
    std::vector<Element> elements = chain.elements();
    Index k = 0;
    const auto knows_next = [&] { return is_known[static_cast<std::size_t>(k++)]; };
    for (Element& element : elements) {
        if (!element.parameter.empty() && knows_next()) {
            element.value += values[k - 1];
            element.parameter.clear();
        }
        std::vector<ErrorTerm> open;
        for (ErrorTerm& term : element.terms) {
            if (knows_next()) {
                element.known_terms.push_back({std::move(term.function), values[k - 1]});
            } else {
                open.push_back(std::move(term));
            }
        }
        element.terms = std::move(open);
    }
    return chain.with_elements(std::move(elements));
}

}  // namespace posewise
