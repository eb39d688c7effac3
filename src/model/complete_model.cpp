#include "complete_model.hpp"

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

}  // namespace

Chain complete_model(const Chain& chain) {
    std::vector<Element> elements;
    const std::vector<Index> owners = element_owners(chain);
    for (std::size_t k = 0; k < owners.size(); ++k) {
        Element element = chain.elements()[k];
        element.parameter.clear();
        const Index owner = owners[k];
        if (owner < 0) {
            elements.push_back(element);
            continue;
        }
        const std::string name = chain.joints()[static_cast<std::size_t>(owner)].name;
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
    return complete_model(with_harmonics(with_torque_shapes(chain, gravity), {1, 2}));
}

}  // namespace posewise::detail
