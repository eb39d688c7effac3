#include <algorithm>

#include "posewise/model/chain.hpp"
#include "urdf_tree.hpp"

namespace posewise::detail {
namespace {

using io::UrdfJoint;
using io::UrdfJointKind;

/// What a fixed joint moves a link by or, after the element that a moving one drives, what turns
/// its frame to that of the link.
Isometry3d fixed_part(const UrdfJoint& joint) {
    std::vector<Element> elements = origin_elements(joint.xyz, joint.rpy);
    if (joint.kind != UrdfJointKind::Fixed) {
        elements = joint_elements(joint_motion(joint), joint.axis, 0);
        const auto is_driven = [](const Element& element) { return !element.joints.empty(); };
        elements.erase(elements.begin(),
                       std::find_if(elements.begin(), elements.end(), is_driven) + 1);
    }
    return Chain({}, elements).base_from_flange(VectorXd(), VectorXd());
}

/// The links that fixed joints hang on a link, but for the one on the way to the tip.
void add_fixed_links(const XmlDocument& document, const LinkPlace& parent, pugi::xml_node on_way,
                     std::vector<LinkPlace>& places) {
    const std::string name = parent.link.attribute("name").value();
    const pugi::xml_node robot = document.root();
    for (const pugi::xml_node element : robot.children("joint")) {
        const bool is_fixed = std::string_view(element.attribute("type").value()) == "fixed";
        if (!is_fixed || element == on_way) continue;
        if (name != element.child("parent").attribute("link").value()) continue;
        const std::string child = element.child("child").attribute("link").value();
        LinkPlace place = parent;
        place.link = robot.find_child_by_attribute("link", "name", child.c_str());
        place.in_frame = parent.in_frame * fixed_part(read_urdf_joint(document, element));
        places.push_back(place);
        add_fixed_links(document, place, on_way, places);
    }
}

}  // namespace

std::vector<LinkPlace> place_links(const XmlDocument& document, const UrdfPath& path) {
    std::vector<LinkPlace> places;
    LinkPlace place;
    for (std::size_t k = 0; k < path.links.size(); ++k) {
        if (k > 0) {
            const UrdfJoint joint = read_urdf_joint(document, path.joints[k - 1]);
            if (joint.mimic && !place.mimic) place.mimic = joint;
            if (joint.kind != UrdfJointKind::Fixed) {
                ++place.moving;
                place.in_frame.setIdentity();
            }
            place.in_frame = place.in_frame * fixed_part(joint);
        }
        place.link = path.links[k];
        places.push_back(place);
    }
    return places;
}

std::vector<LinkPlace> place_bodies(const XmlDocument& document, const UrdfPath& path) {
    std::vector<LinkPlace> places;
    const std::vector<LinkPlace> on_way = place_links(document, path);
    for (std::size_t k = 0; k < on_way.size(); ++k) {
        places.push_back(on_way[k]);
        const auto next = k < path.joints.size() ? path.joints[k] : pugi::xml_node();
        add_fixed_links(document, on_way[k], next, places);
    }
    return places;
}

}  // namespace posewise::detail
