#pragma once

#include "io/format/xml_document.hpp"
#include "posewise/io/robot_files.hpp"

namespace posewise::detail {

/// The way from a base link to a tip link in the tree of a URDF document.
struct UrdfPath {
    io::UrdfSource source;               ///< links filled in
    std::vector<pugi::xml_node> links;   ///< base to tip
    std::vector<pugi::xml_node> joints;  ///< one less
};

/// Throws InputError as read_urdf() does for what is wrong with the tree.
UrdfPath find_path(const XmlDocument& document, const io::UrdfSource& source);

/// Where a link is.
struct LinkPlace {
    pugi::xml_node link;
    Index moving =
        0;  ///< joints that move from the base up to it: its frame is that after the last
    Isometry3d in_frame = Isometry3d::Identity();  ///< the link there
    std::optional<io::UrdfJoint> mimic =
        {};  ///< the first on the way there, whose frame has no name
};
/// The links from base to tip.
std::vector<LinkPlace> place_links(const XmlDocument& document, const UrdfPath& path);
/// The same with the links that fixed joints hang on them.
std::vector<LinkPlace> place_bodies(const XmlDocument& document, const UrdfPath& path);

/// The only child of that name; an empty node if there is none. Throws InputError if there are two.
pugi::xml_node find_child(const XmlDocument& document, pugi::xml_node parent, const char* name);

/// A number, or three, in an attribute; nothing if it is not there. `subject` is whose it is, for
/// messages. Throws InputError unless each is at most 1e6 in magnitude.
std::optional<double> read_number(const XmlDocument& document, pugi::xml_node element,
                                  const char* attribute, const std::string& subject);
std::optional<Vector3d> read_vector(const XmlDocument& document, pugi::xml_node element,
                                    const char* attribute, const std::string& subject);

/// Three numbers as an attribute has them, in digits that read back exactly and never "-0".
std::string vector_text(const Vector3d& v);

/// Whether a name is of another namespace than the format's own, "drake:acceleration": an extension
/// of other programs, no slip.
inline bool is_foreign(std::string_view name) { return name.find(':') != std::string_view::npos; }

/// The joint in an element <joint> on the way from base to tip.
io::UrdfJoint read_urdf_joint(const XmlDocument& document, pugi::xml_node element);

/// io::make_chain() of a robot whose limits, stated or not, do not matter.
Chain make_chain_without_limits(io::UrdfRobot robot);

/// What is constant before, between and after the joints of a chain: base_from_flange(q) =
/// C_0 M_1(q_1) C_1 ... M_n(q_n) C_n. The constant part of a joint's element counts to what is
/// before it, error terms to none.
std::vector<Isometry3d> constants_of(const Chain& robot, const VectorXd& parameters);

}  // namespace posewise::detail
