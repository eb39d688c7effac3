#include <algorithm>
#include <numbers>

#include "io/campaign/robot_parts.hpp"
#include "io/format/text.hpp"
#include "urdf_tree.hpp"

namespace posewise::detail {
namespace {

using pugi::xml_node;

/// Reads one <joint>.
class JointReader {
  public:
    JointReader(const XmlDocument& document, xml_node element)
        : document_(document), element_(element), name_(element.attribute("name").value()) {}

    io::UrdfJoint read() const {
        refuse_misspelt_children();
        io::UrdfJoint joint;
        joint.name = name_;
        joint.location = document_.location(element_);
        joint.kind = read_kind();
        if (const xml_node origin = find("origin", {"xyz", "rpy"})) {
            joint.xyz = read_vector(origin, "xyz").value_or(joint.xyz);
            joint.rpy = read_vector(origin, "rpy").value_or(joint.rpy);
        }
        if (joint.kind == io::UrdfJointKind::Fixed) return joint;
        read_mimic(joint);
        read_axis(joint);
        read_limit(joint);
        return joint;
    }

  private:
    InputError error(xml_node at, const std::string& problem) const {
        return document_.error(at, "joint " + quote(name_) + ' ' + problem);
    }

    /// A misspelt <origin> would silently be no origin.
    void refuse_misspelt_children() const {
        const std::vector<std::string> known{"origin", "parent",   "child",
                                             "axis",   "limit",    "calibration",
                                             "mimic",  "dynamics", "safety_controller"};
        for (const xml_node child : element_.children()) {
            if (child.type() != pugi::node_element) continue;
            const std::string name = child.name();
            if (is_foreign(name)) continue;
            if (std::find(known.begin(), known.end(), name) != known.end()) continue;
            const std::string advice = suggest(name, known);
            if (!advice.starts_with("did you mean")) continue;
            throw error(child, "has an element " + quote(name) + "; " + advice);
        }
    }

    /// Throws for an unknown attribute of the format's own; where `warnings` are taken only for a
    /// misspelt one.
    xml_node find(const char* name, const std::vector<std::string>& attributes,
                  std::vector<std::string>* warnings = nullptr) const {
        const xml_node found = find_child(document_, element_, name);
        for (const pugi::xml_attribute attribute : found.attributes()) {
            const std::string stated = attribute.name();
            if (is_foreign(stated)) continue;
            if (std::find(attributes.begin(), attributes.end(), stated) != attributes.end()) {
                continue;
            }
            const std::string what =
                std::string("has ") + name + " with unknown attribute " + quote(stated);
            const std::string advice = suggest(stated, attributes);
            if (warnings == nullptr || advice.starts_with("did you mean")) {
                throw error(found, what + "; " + advice);
            }
            warnings->push_back(error(found, what + ", which is left out").what());
        }
        return found;
    }

    io::UrdfJointKind read_kind() const {
        const pugi::xml_attribute type = element_.attribute("type");
        if (!type) throw error(element_, "has no type; it must be stated");
        const std::string word = type.value();
        if (word == "fixed") return io::UrdfJointKind::Fixed;
        if (word == "revolute") return io::UrdfJointKind::Revolute;
        if (word == "continuous") return io::UrdfJointKind::Continuous;
        if (word == "prismatic") return io::UrdfJointKind::Prismatic;
        const std::vector<std::string> known{"revolute", "continuous", "prismatic", "fixed"};
        const bool has_many_freedoms = word == "floating" || word == "planar";
        throw error(
            element_,
            "is of type " + quote(word) +
                (has_many_freedoms ? ", which moves in several ways at once; must be one of " +
                                         list_words(known) + ", or not between base and tip link"
                                   : "; " + suggest(word, known)));
    }

    std::optional<Vector3d> read_vector(xml_node element, const char* attribute) const {
        return detail::read_vector(document_, element, attribute, "joint " + quote(name_));
    }

    void read_axis(io::UrdfJoint& joint) const {
        const xml_node axis = find("axis", {"xyz"});
        if (!axis) return;  // x, says the format
        const Vector3d direction = read_vector(axis, "xyz").value_or(joint.axis);
        constexpr double least = 1e-6;
        if (direction.norm() < least) {
            throw error(axis, "has the axis " + quote(axis.attribute("xyz").value()) +
                                  ", which has no direction; must not be zero");
        }
        joint.axis = direction.normalized();
    }

    void read_mimic(io::UrdfJoint& joint) const {
        const xml_node mimic = find("mimic", {"joint", "multiplier", "offset"});
        if (!mimic) return;
        const std::string subject = "joint " + quote(name_);
        joint.mimic = io::UrdfMimic{mimic.attribute("joint").value()};
        if (joint.mimic->joint.empty()) throw error(mimic, "has a <mimic> without joint");
        joint.mimic->factor = read_number(document_, mimic, "multiplier", subject).value_or(1);
        if (joint.mimic->factor == 0) {
            throw error(mimic, "has multiplier 0; must move, or be of type fixed");
        }
        joint.mimic->offset = read_number(document_, mimic, "offset", subject).value_or(0);
    }

    /// 0 if it is not stated. Files write huge numbers for none.
    double read_limit_number(xml_node limit, const char* attribute) const {
        const pugi::xml_attribute stated = limit.attribute(attribute);
        if (!stated) return 0;
        const ParsedNumber number = parse_number(stated.value());
        if (number.ok()) return number.value;
        return read_number(document_, limit, attribute, "joint " + quote(name_)).value_or(0);
    }

    void read_limit(io::UrdfJoint& joint) const {
        constexpr double none = 1e3;  // rad or m, or a second of it: what is more is no limit
        const xml_node limit =
            find("limit",
                 {"lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"},
                 &joint.warnings);
        joint.speed = read_limit_number(limit, "velocity");
        if (joint.speed < 0) throw error(limit, "has a negative velocity; must be positive");
        if (joint.speed > none) joint.speed = 0;
        const Interval stated{read_limit_number(limit, "lower"), read_limit_number(limit, "upper")};
        if (stated.lower > stated.upper) {
            throw error(limit, "has limits that are not in order; lower must be below upper");
        }
        const double largest = std::max(-stated.lower, stated.upper);
        const bool is_revolute = joint.kind == io::UrdfJointKind::Revolute;
        if (is_revolute && largest > none) {
            if (-stated.lower < none || stated.upper < none) {
                throw error(limit,
                            "has a limit on one side only; must have both, or be continuous");
            }
            joint.kind = io::UrdfJointKind::Continuous;
        }
        if (joint.kind == io::UrdfJointKind::Continuous) {
            joint.limits = Interval{-std::numbers::pi, std::numbers::pi};
        } else if (is_revolute && largest > most_turns * 2 * std::numbers::pi) {
            throw error(limit, "has limits beyond three turns; must be rad: are they degrees?");
        } else if (stated.lower < stated.upper && largest <= none) {
            joint.limits = stated;
        }
    }

    const XmlDocument& document_;
    const xml_node element_;
    std::string name_;
};

}  // namespace

io::UrdfJoint read_urdf_joint(const XmlDocument& document, xml_node element) {
    return JointReader(document, element).read();
}

}  // namespace posewise::detail
