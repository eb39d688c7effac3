#include <algorithm>

#include "element_notation.hpp"
#include "io/format/text.hpp"
#include "keys.hpp"
#include "posewise/model/dh.hpp"
#include "robot_parts.hpp"

namespace posewise::detail {
namespace {

/// A row as it stands in the file.
struct RowText {
    YamlMap map;
    std::optional<YamlValue> joint;  ///< nothing: a fixed row
    Motion motion = Motion::Rotation;
};

Motion read_kind(const YamlValue& value) {
    const std::string word = value.text();
    if (word == "revolute") return Motion::Rotation;
    if (word == "prismatic") return Motion::Translation;
    throw value.error("is " + quote(word) + "; " + suggest(word, {"revolute", "prismatic"}));
}

RowText read_row_text(const YamlValue& value) {
    const YamlMap map(value, keys::row);
    RowText row{map, map.find("joint")};
    const auto kind = row.map.find("kind");
    if (row.joint) {
        check_joint_name(row.joint->text(), row.joint->location());
        if (kind) row.motion = read_kind(*kind);
        return row;
    }
    for (const auto& stated : {kind, row.map.find("drive")}) {
        if (stated) throw stated->error("is stated, but its row has no joint");
    }
    for (const char* const key : {"limits", "repeatability", "pitch"}) {
        if (const auto stated = row.map.find_measure(key)) {
            throw stated->value.error("is stated, but its row has no joint");
        }
    }
    return row;
}

/// One unit of length and one of angle in the whole table: two of them are a slip.
class TableUnits {
  public:
    double read(const RowText& row, std::string_view key) {
        return to_si(row.map.require_measure(key));
    }
    /// 0 if it is not stated.
    double read_optional(const RowText& row, std::string_view key) {
        const auto measure = row.map.find_measure(key);
        return measure ? to_si(*measure) : 0;
    }

  private:
    double to_si(const YamlMeasure& measure) {
        const Unit*& unit = measure.unit->quantity == Quantity::Angle ? angle_ : length_;
        if (unit == nullptr) unit = measure.unit;
        if (unit != measure.unit) {
            throw measure.value.error("is in '" + std::string(measure.unit->name) +
                                      "', but others of the table are in '" +
                                      std::string(unit->name) + "'; must be one unit");
        }
        return measure.to_si();
    }

    const Unit* angle_ = nullptr;
    const Unit* length_ = nullptr;
};

std::vector<std::string> joint_names(const std::vector<RowText>& rows) {
    std::vector<std::string> names;
    for (const RowText& row : rows) {
        if (!row.joint) continue;
        const std::string name = row.joint->text();
        if (std::find(names.begin(), names.end(), name) != names.end()) {
            throw row.joint->error("is " + quote(name) + " as in a row before; must be another");
        }
        names.push_back(name);
    }
    return names;
}

std::vector<JointTerm> read_drive(const RowText& row, Index joint, ElementParser& parser) {
    const auto drive = row.map.find("drive");
    const YamlValue& value = drive ? *drive : *row.joint;
    const auto terms = parser.parse_drive(value.text(), value.text_location(), row.motion);
    const auto is_own = [joint](const JointTerm& term) { return term.joint == joint; };
    if (std::none_of(terms.begin(), terms.end(), is_own)) {
        throw value.error("is " + quote(value.text()) + "; must contain " +
                          quote(row.joint->text()) + ", the joint of its row");
    }
    return terms;
}

bool read_is_modified(const YamlValue& convention) {
    const std::string word = convention.text();
    if (word == "standard") return false;
    if (word == "modified") return true;
    throw convention.error("is " + quote(word) + "; " + suggest(word, {"standard", "modified"}));
}

std::vector<RowText> read_row_texts(const YamlValue& value) {
    std::vector<RowText> rows;
    for (const YamlValue& item : value.list()) rows.push_back(read_row_text(item));
    const auto joint_count = static_cast<std::size_t>(std::count_if(
        rows.begin(), rows.end(), [](const RowText& row) { return row.joint.has_value(); }));
    if (joint_count == 0) throw value.error("names no joint; a row must be of a joint");
    if (joint_count > most_joints || rows.size() > most_elements / 4) {
        throw value.error("has " + std::to_string(rows.size()) +
                          " rows; must be at most 250, 100 of them of a joint");
    }
    return rows;
}

}  // namespace

RobotSection read_dh(const YamlValue& value) {
    const YamlMap dh(value, keys::dh);
    const bool is_modified = read_is_modified(dh.require("convention"));
    const std::vector<RowText> rows = read_row_texts(dh.require("rows"));
    ElementParser parser(joint_names(rows));
    TableUnits units;
    RobotSection section;
    std::vector<Joint> joints;
    std::vector<double> repeatability;
    std::vector<Element> elements;
    for (const RowText& text : rows) {
        DhRow row{units.read(text, "a"),
                  units.read(text, "alpha"),
                  units.read(text, "d"),
                  units.read(text, "theta"),
                  text.motion,
                  {},
                  units.read_optional(text, "beta")};
        if (const auto beta = text.map.find_measure("beta"); beta && is_modified) {
            throw beta->value.error(
                "is stated in a table of the modified convention; only the standard one has it");
        }
        if (text.joint) {
            row.joints = read_drive(text, static_cast<Index>(joints.size()), parser);
            joints.push_back(read_limited_joint(text.map, text.joint->text(), text.motion));
            repeatability.push_back(read_repeatability(text.map, text.motion));
        }
        for (Element& element : is_modified ? mdh_elements(row) : dh_elements(row)) {
            elements.push_back(std::move(element));
        }
    }
    section.declared = Chain(std::move(joints), std::move(elements));
    section.joint_repeatability =
        Eigen::Map<const VectorXd>(repeatability.data(), section.declared.joint_count());
    return section;
}

}  // namespace posewise::detail
