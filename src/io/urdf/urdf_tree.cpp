#include "urdf_tree.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "io/format/text.hpp"

namespace posewise::detail {
namespace {

using pugi::xml_node;

std::string require_attribute(const XmlDocument& document, xml_node element, const char* name) {
    const std::string value = element.attribute(name).value();
    const std::string what = "a <" + std::string(element.name()) + "> has ";
    if (value.empty()) {
        throw document.error(element, what + "no " + name + "; it must be stated");
    }
    if (escape_controls(value) != value) {
        throw document.error(element, what + name + ' ' + quote(value) +
                                          "; must be one line without control characters");
    }
    return value;
}

std::string name_of(xml_node element) { return element.attribute("name").value(); }

/// All links, and the joint above each.
class Tree {
  public:
    explicit Tree(const XmlDocument& document) : document_(document) {
        const xml_node robot = document.root();
        if (std::string_view(robot.name()) != "robot") {
            throw document.error(robot, "is no URDF: its root element is <" +
                                            escape_controls(robot.name()) + ">; must be <robot>");
        }
        for (const xml_node link : robot.children("link")) add_unique(links_, link, "link");
        for (const xml_node joint : robot.children("joint")) {
            add_unique(joints_, joint, "joint");
            join(joint);
        }
        if (links_.empty()) throw document.error(robot, "has no <link>; a robot must have links");
    }

    std::string find_root() const {
        for (const auto& [name, link] : links_) {
            if (above_.count(name) == 0) return name;
        }
        throw input_error_at({document_.path()}, "has no root link: its joints form a cycle");
    }

    std::string find_leaf_below(const std::string& base) const {
        std::vector<std::string> leaves;
        std::vector<std::string> open{base};
        for (std::size_t steps = 0; !open.empty() && steps <= links_.size(); ++steps) {
            const std::string link = open.back();
            open.pop_back();
            const auto [first, last] = children_.equal_range(link);
            if (first == last && link != base) leaves.push_back(link);
            for (auto child = first; child != last; ++child) open.push_back(child->second);
        }
        if (leaves.size() == 1) return leaves.front();
        std::sort(leaves.begin(), leaves.end());
        throw input_error_at({document_.path()},
                             leaves.empty() ? "has no tip link below base link " + quote(base)
                                            : "the tip link must be named (--tip), it could be " +
                                                  list_words(leaves));
    }

    void check_link(const std::string& name) const {
        if (links_.count(name) != 0) return;
        throw input_error_at({document_.path()},
                             "has no link " + quote(name) + "; " + suggest(name, link_names()));
    }

    xml_node link(const std::string& name) const { return links_.at(name); }

    xml_node child(xml_node joint) const { return link(end_of(joint, "child")); }

    std::vector<xml_node> path(const std::string& base, const std::string& tip) const {
        std::vector<xml_node> joints;
        std::string link = tip;
        while (link != base) {
            const auto above = above_.find(link);
            if (above == above_.end()) {
                throw input_error_at({document_.path()},
                                     "tip link " + quote(tip) + " is not below base link " +
                                         quote(base) + " but below " + quote(link) +
                                         " only; must be below it");
            }
            if (joints.size() > joints_.size()) {
                throw document_.error(above->second.joint,
                                      "joint " + quote(name_of(above->second.joint)) +
                                          " closes a cycle; links must form a tree");
            }
            joints.push_back(above->second.joint);
            link = above->second.parent;
        }
        std::reverse(joints.begin(), joints.end());
        return joints;
    }

  private:
    using Elements = std::map<std::string, xml_node>;
    struct Above {
        xml_node joint;
        std::string parent;
    };

    void add_unique(Elements& elements, xml_node element, const char* what) const {
        const std::string name = require_attribute(document_, element, "name");
        const auto [first, is_new] = elements.emplace(name, element);
        if (is_new) return;
        const long line = document_.location(first->second).line;
        throw document_.error(element, std::string(what) + ' ' + quote(name) +
                                           " occurs twice, first in line " + std::to_string(line) +
                                           "; must have a name of its own");
    }

    std::string end_of(xml_node joint, const char* end) const {
        const xml_node element = find_child(document_, joint, end);
        if (!element) {
            throw document_.error(joint, "joint " + quote(name_of(joint)) + " has no <" + end +
                                             ">; it must be stated");
        }
        const std::string link = require_attribute(document_, element, "link");
        if (links_.count(link) == 0) {
            throw document_.error(element, "joint " + quote(name_of(joint)) + " has " + end + ' ' +
                                               quote(link) + ", which is no link of this robot; " +
                                               suggest(link, link_names()));
        }
        return link;
    }

    void join(xml_node joint) {
        const std::string child = end_of(joint, "child");
        const std::string parent = end_of(joint, "parent");
        const auto [first, is_new] = above_.emplace(child, Above{joint, parent});
        if (!is_new) {
            throw document_.error(joint, "link " + quote(child) + " is the child of two joints, " +
                                             quote(name_of(first->second.joint)) + " and " +
                                             quote(name_of(joint)) + "; links must form a tree");
        }
        children_.emplace(parent, child);
    }

    std::vector<std::string> link_names() const {
        std::vector<std::string> names;
        for (const auto& [name, link] : links_) names.push_back(name);
        return names;
    }

    const XmlDocument& document_;
    Elements links_;
    Elements joints_;
    std::map<std::string, Above> above_;  // by child link
    std::multimap<std::string, std::string> children_;
};

/// Whether something in it, at most `depth` levels down, stands for what xacro would make of it.
void refuse_template(const XmlDocument& document, xml_node parent, int depth) {
    for (const xml_node element : parent.children()) {
        if (std::string_view(element.name()).starts_with("xacro:")) {
            throw document.error(element,
                                 "is a template for xacro; must be what xacro makes of it");
        }
        if (depth > 1) refuse_template(document, element, depth - 1);
    }
}

/// A template may stand for links, joints or parts of them; in what a link looks like it is of no
/// matter here.
void refuse_template(const XmlDocument& document) {
    refuse_template(document, document.root(), 1);
    for (const xml_node joint : document.root().children("joint")) {
        refuse_template(document, joint, 2);
    }
    for (const xml_node link : document.root().children("link")) {
        refuse_template(document, link, 1);
        refuse_template(document, link.child("inertial"), 1);
    }
}

constexpr double most = 1e6;  // m, rad or kg: no robot has more

double parse(const XmlDocument& document, xml_node element, const char* attribute,
             std::string_view text, const std::string& subject, const char* rule) {
    const ParsedNumber number = parse_number(text);
    if (number.ok() && std::abs(number.value) <= most) return number.value;
    throw document.error(element,
                         subject + " has " + std::string(element.name()) + ' ' + attribute + ' ' +
                             quote(element.attribute(attribute).value()) + "; must be " + rule);
}

}  // namespace

std::optional<double> read_number(const XmlDocument& document, xml_node element,
                                  const char* attribute, const std::string& subject) {
    const pugi::xml_attribute stated = element.attribute(attribute);
    if (!stated) return std::nullopt;
    return parse(document, element, attribute, stated.value(), subject,
                 "a number of at most 1e+06 in magnitude");
}

std::optional<Vector3d> read_vector(const XmlDocument& document, xml_node element,
                                    const char* attribute, const std::string& subject) {
    const pugi::xml_attribute stated = element.attribute(attribute);
    if (!stated) return std::nullopt;
    constexpr const char* rule = "three numbers, each at most 1e+06 in magnitude";
    std::istringstream words(stated.value());
    std::vector<double> values;
    for (std::string word; words >> word;) {
        values.push_back(parse(document, element, attribute, word, subject, rule));
    }
    if (values.size() == 3) return Vector3d(values[0], values[1], values[2]);
    throw document.error(element, subject + " has " + std::string(element.name()) + ' ' +
                                      attribute + ' ' + quote(stated.value()) + "; must be " +
                                      rule);
}

UrdfPath find_path(const XmlDocument& document, const io::UrdfSource& source) {
    refuse_template(document);
    const Tree tree(document);
    UrdfPath path{source, {}, {}};
    std::string& base = path.source.base_link;
    std::string& tip = path.source.tip_link;
    if (base.empty()) base = tree.find_root();
    tree.check_link(base);
    if (tip.empty()) tip = tree.find_leaf_below(base);
    tree.check_link(tip);
    path.joints = tree.path(base, tip);
    path.links.push_back(tree.link(base));
    for (const xml_node joint : path.joints) path.links.push_back(tree.child(joint));
    return path;
}

xml_node find_child(const XmlDocument& document, xml_node parent, const char* name) {
    const xml_node child = parent.child(name);
    if (const xml_node second = child.next_sibling(name)) {
        throw document.error(second, std::string("a second <") + name + "> in one <" +
                                         parent.name() + ">; must be one");
    }
    return child;
}

std::string vector_text(const Vector3d& v) {
    return fmt::format("{} {} {}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

}  // namespace posewise::detail
