#include <algorithm>

#include "posewise/io/urdf_file.hpp"
#include "posewise/model/transforms.hpp"
#include "text.hpp"
#include "urdf_tree.hpp"

namespace posewise::io {
namespace {

using namespace detail;
using pugi::xml_node;

/// The mass of a link, its centre in the link's own frame. Nothing if it states none.
std::optional<Load> read_load(const XmlDocument& document, xml_node link) {
    const xml_node inertial = find_child(document, link, "inertial");
    if (!inertial) return std::nullopt;
    const std::string subject = "link " + quote(link.attribute("name").value());
    const xml_node mass = find_child(document, inertial, "mass");
    const auto value = mass ? read_number(document, mass, "value", subject) : std::nullopt;
    if (!value) {
        throw document.error(inertial, subject +
                                           " has an <inertial> without <mass value=..>; it "
                                           "must be stated");
    }
    if (*value < 0) throw document.error(mass, subject + " has a negative mass");
    Load load{0, *value, Vector3d::Zero()};
    if (const xml_node origin = find_child(document, inertial, "origin")) {
        load.center = read_vector(document, origin, "xyz", subject).value_or(load.center);
    }
    return load;
}

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

}  // namespace

std::vector<Load> read_urdf_loads(const UrdfSource& source) {
    const XmlDocument document(source.path);
    const UrdfPath path = find_path(document, source);
    std::vector<Load> loads;
    Index moving = 0;                              // joints that move up to the link
    Isometry3d in_frame = Isometry3d::Identity();  // the link in the frame after the last of them
    for (std::size_t k = 0; k < path.links.size(); ++k) {
        if (k > 0) {
            const UrdfJoint joint = read_urdf_joint(document, path.joints[k - 1]);
            if (joint.mimic) {
                throw input_error_at(joint.location,
                                     "joint " + quote(joint.name) +
                                         " is a mimic; masses of a robot that has one must be "
                                         "stated under robot.compliance.links");
            }
            if (joint.kind != UrdfJointKind::Fixed) {
                ++moving;
                in_frame.setIdentity();
            }
            in_frame = in_frame * fixed_part(joint);
        }
        std::optional<Load> load = read_load(document, path.links[k]);
        if (!load || load->mass == 0) continue;
        load->link = moving;
        load->center = in_frame * load->center;
        loads.push_back(*load);
    }
    if (loads.empty()) {
        throw input_error_at({path.source.path}, "states no mass of a link from " +
                                                     quote(path.source.base_link) + " to " +
                                                     quote(path.source.tip_link));
    }
    return loads;
}

}  // namespace posewise::io
