#include "posewise/model/dh.hpp"

namespace posewise {
namespace {

std::vector<JointTerm> driving(const DhRow& row, Motion motion) {
    return row.motion == motion ? row.joints : std::vector<JointTerm>();
}

Element joint_rotation(const DhRow& row) {
    return {Motion::Rotation, Axis::Z, row.theta, driving(row, Motion::Rotation), ""};
}

Element joint_translation(const DhRow& row) {
    return {Motion::Translation, Axis::Z, row.d, driving(row, Motion::Translation), ""};
}

Element link_translation(const DhRow& row) { return {Motion::Translation, Axis::X, row.a, {}, ""}; }

Element link_rotation(const DhRow& row) { return {Motion::Rotation, Axis::X, row.alpha, {}, ""}; }

std::vector<Element> without_idle(std::vector<Element> elements) {
    std::erase_if(elements, [](const Element& element) {
        return element.value == 0 && element.joints.empty();
    });
    return elements;
}

}  // namespace

std::vector<Element> dh_elements(const DhRow& row) {
    return without_idle(
        {joint_rotation(row), joint_translation(row), link_translation(row), link_rotation(row)});
}

std::vector<Element> mdh_elements(const DhRow& row) {
    return without_idle(
        {link_rotation(row), link_translation(row), joint_rotation(row), joint_translation(row)});
}

}  // namespace posewise
