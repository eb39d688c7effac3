#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "posewise/core/types.hpp"

/// URDF files in a few words.
namespace posewise::testing {

/// Three numbers, separated by blanks, as read back.
inline std::string vector_text(const Vector3d& v) {
    std::ostringstream words;
    words.precision(17);
    words << v.x() << ' ' << v.y() << ' ' << v.z();
    return words.str();
}

struct JointText {
    std::string type;
    std::string origin;  ///< attributes, `xyz="0 0 1" rpy="0 0 0"`; empty: no element
    std::string axis;    ///< "0 0 1"; empty: no element
    std::string limit = R"(lower="-2" upper="2" effort="1" velocity="3")";
};

/// A serial robot of links link0, link1, ... and joints q1, q2, ...; the fixed ones take numbers
/// too.
inline std::string urdf_text(const std::vector<JointText>& joints) {
    std::string text = "<?xml version=\"1.0\"?>\n<robot name=\"test\">\n  <link name=\"link0\"/>\n";
    for (std::size_t k = 0; k < joints.size(); ++k) {
        const JointText& joint = joints[k];
        const std::string number = std::to_string(k + 1);
        text += "  <link name=\"link" + number + "\"/>\n";
        text += "  <joint name=\"q" + number + "\" type=\"" + joint.type + "\">\n";
        text += "    <parent link=\"link" + std::to_string(k) + "\"/>\n";
        text += "    <child link=\"link" + number + "\"/>\n";
        if (!joint.origin.empty()) text += "    <origin " + joint.origin + "/>\n";
        if (!joint.axis.empty()) text += "    <axis xyz=\"" + joint.axis + "\"/>\n";
        const bool has_limit = joint.type == "revolute" || joint.type == "prismatic";
        if (has_limit) text += "    <limit " + joint.limit + "/>\n";
        text += "  </joint>\n";
    }
    return text + "</robot>\n";
}

}  // namespace posewise::testing
