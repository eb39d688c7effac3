#include "io/format/text.hpp"
#include "posewise/io/robot_files.hpp"
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

}  // namespace

std::vector<Load> read_urdf_loads(const UrdfSource& source) {
    const XmlDocument document(source.path);
    const UrdfPath path = find_path(document, source);
    std::vector<Load> loads;
    for (const LinkPlace& place : place_links(document, path)) {
        if (place.mimic) {
            throw input_error_at(place.mimic->location,
                                 "joint " + quote(place.mimic->name) +
                                     " is a mimic; masses of a robot that has one must be "
                                     "stated under robot.compliance.links");
        }
        std::optional<Load> load = read_load(document, place.link);
        if (!load || load->mass == 0) continue;
        load->link = place.moving;
        load->center = place.in_frame * load->center;
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
