#include "points_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "core/text.hpp"
#include "io/format/csv_reader.hpp"
#include "io/format/text.hpp"
#include "measurement_columns.hpp"

namespace posewise::detail {
namespace {

using Fields = std::vector<std::string_view>;

constexpr Unit inches{"inch", Quantity::Length, 25.4, 1e3};

constexpr std::array<std::string_view, 9> names_of_name{
    "name", "point", "target", "id", "point name", "point id", "target name", "label", "object"};
/// Of an instrument's program, and of the targets that plan writes: not needed.
constexpr std::array<std::string_view, 10> names_without_use{
    "collection", "group",       "point group",   "group name",    "collection name",
    "range_mm",   "azimuth_deg", "elevation_deg", "incidence_deg", "visible"};

std::string lower(std::string_view text) {
    std::string small(text);
    for (char& c : small) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return small;
}

/// A column's name in small letters and its unit, which stands behind `_` or a blank or in
/// brackets.
struct Title {
    std::string words;
    std::string unit;  ///< empty: none
};

/// Of those that are not read, the usual ones, so that they can be named.
bool is_unit(const std::string& text) {
    return find_unit(text) != nullptr || find_point_unit(text) != nullptr || text == "ft" ||
           text == "cm";
}

Title read_title(std::string_view field) {
    Title title{lower(field), ""};
    const std::size_t opening = title.words.find_first_of("[(");
    if (opening != std::string::npos) {
        const std::size_t closing = title.words.find_first_of("])", opening);
        title.unit = trim(std::string_view(title.words).substr(opening + 1, closing - opening - 1));
        title.words.erase(opening);
    } else if (const std::size_t at = title.words.find_last_of("_ ");
               at != std::string::npos && is_unit(title.words.substr(at + 1))) {
        title.unit = title.words.substr(at + 1);
        title.words.erase(at);
    }
    title.words = trim(title.words);
    return title;
}

/// 0 to 2 for x, y and z, measured ones if that is said.
std::optional<std::size_t> axis_of(std::string words) {
    for (const std::string_view said : {"measured", "actual", "meas", "act"}) {
        const std::size_t at = words.find(said);
        if (at == std::string::npos) continue;
        words.erase(at, said.size());
        break;
    }
    std::erase_if(words, [](char c) { return c == ' ' || c == '_' || c == '.'; });
    if (words.size() != 1 || words[0] < 'x' || words[0] > 'z') return std::nullopt;
    return static_cast<std::size_t>(words[0] - 'x');
}

bool is_number(std::string_view field) {
    return parse_number(field).problem != std::string_view("is not a number");
}

/// Titles of a header that blanks part from their units in brackets.
std::vector<std::string> join_brackets(const Fields& fields) {
    std::vector<std::string> titles;
    for (const std::string_view field : fields) {
        if (!titles.empty() && (field.starts_with('[') || field.starts_with('('))) {
            titles.back() += field;
        } else {
            titles.emplace_back(field);
        }
    }
    return titles;
}

bool is_header(const Fields& fields) {
    std::array<bool, 3> has{};
    for (const std::string& title : join_brackets(fields)) {
        if (const auto axis = axis_of(read_title(title).words)) has[*axis] = true;
    }
    return has[0] && has[1] && has[2];
}

/// Where name and coordinates stand in a row.
struct Layout {
    std::size_t width = 0;
    std::optional<std::size_t> name;
    std::array<std::size_t, 3> coordinates{};
    std::optional<std::size_t> time;
    std::optional<std::size_t> temperature;
    bool has_header = false;
};

class ListReader {
  public:
    ListReader(const std::string& path, std::string content, const Unit* unit)
        : path_(path), csv_(path, std::move(content), CsvStyle::List), unit_(unit) {}

    PointsList read() {
        if (!csv_.next_row()) {
            throw input_error_at({path_}, "is empty; must be a list of points, name x y z");
        }
        bool is_row = true;
        if (is_header(csv_.fields())) {
            read_header();
            is_row = csv_.next_row();
        } else {
            find_layout();
        }
        for (; is_row; is_row = csv_.next_row()) read_row();
        if (list_.points.empty()) {
            throw input_error_at({path_}, "has a header but no rows; must have at least one row");
        }
        return std::move(list_);
    }

  private:
    InputError error(std::size_t field, const std::string& problem) const {
        return input_error_at(csv_.locate(field), problem);
    }

    void read_header() {
        const std::vector<std::string> titles = join_brackets(csv_.fields());
        layout_.has_header = true;
        layout_.width = titles.size();
        std::array<std::optional<std::size_t>, 3> found;
        std::array<std::string, 3> units;
        for (std::size_t k = 0; k < titles.size(); ++k) {
            const auto [words, unit] = read_title(titles[k]);
            if (const auto axis = axis_of(words)) {
                if (found[*axis]) {
                    throw error(0, fmt::format("the header has {} twice, {} and {}; keep what was "
                                               "measured",
                                               std::string("xyz")[*axis],
                                               quote(titles[*found[*axis]]), quote(titles[k])));
                }
                found[*axis] = k;
                units[*axis] = unit;
            } else if (std::ranges::find(names_of_name, words) != names_of_name.end()) {
                if (layout_.name) throw error(0, "the header has two columns of names; keep one");
                layout_.name = k;
            } else if (titles[k] == time_column || titles[k] == time_seconds_column) {
                layout_.time = k;
            } else if (titles[k] == temperature_column) {
                layout_.temperature = k;
            } else if (std::ranges::find(names_without_use, lower(titles[k])) ==
                       names_without_use.end()) {
                list_.unused.push_back(titles[k]);
            }
        }
        for (std::size_t axis = 0; axis < 3; ++axis) layout_.coordinates[axis] = *found[axis];
        list_.has_time = layout_.time.has_value();
        list_.has_temperature = layout_.temperature.has_value();
        read_units(units);
    }

    void read_units(const std::array<std::string, 3>& units) {
        if (units[1] != units[0] || units[2] != units[0]) {
            throw error(0, "the header states different units for x, y and z; must be one for all");
        }
        if (units[0].empty()) return;
        const Unit* const stated = find_point_unit(units[0]);
        if (stated == nullptr) {
            throw error(0, fmt::format("the header's unit is {}; must be {}", quote(units[0]),
                                       list_words(point_unit_names())));
        }
        if (unit_ != nullptr && unit_ != stated) {
            throw error(0,
                        fmt::format("the header's unit is {}, `points_unit` is {}; leave that out",
                                    stated->name, unit_->name));
        }
        unit_ = list_.unit = stated;
    }

    /// Of a list without header, by its first row.
    void find_layout() {
        const std::size_t count = row_width();
        layout_.width = count;
        const Fields& fields = csv_.fields();
        const auto is_coordinate = [&](std::size_t k) { return is_number(fields[k]); };
        // A number where a group's point is called is a coordinate of fewer names and more after
        // it.
        const bool is_list = count >= 3 && count <= 6 && is_coordinate(count - 1) &&
                             is_coordinate(count - 2) && is_coordinate(count - 3) &&
                             (count < 5 || !is_coordinate(count - 4));
        if (!is_list) {
            throw error(0,
                        fmt::format("the first row has {}, and is neither a header with x, y and "
                                    "z nor a point; must be x y z, name x y z, group name x y "
                                    "z or collection group name x y z, with decimal points",
                                    count_of(static_cast<Index>(count), "field")));
        }
        if (count > 3) layout_.name = count - 4;
        for (std::size_t k = 0; k < 3; ++k) layout_.coordinates[k] = count - 3 + k;
    }

    /// Without empty fields at the end, where a header does not count them.
    std::size_t row_width() const {
        std::size_t count = csv_.fields().size();
        while (!layout_.has_header && count > 1 && csv_.fields()[count - 1].empty()) --count;
        return count;
    }

    void read_row() {
        const Fields& fields = csv_.fields();
        if (row_width() != layout_.width) {
            throw error(std::min(row_width(), layout_.width),
                        fmt::format("row has {}; must have {} as the {}",
                                    count_of(static_cast<Index>(row_width()), "field"),
                                    layout_.width, layout_.has_header ? "header" : "first row"));
        }
        NamedPoint point{"", Vector3d::Zero(), csv_.locate(layout_.name.value_or(0))};
        if (layout_.name) {
            point.name = fields[*layout_.name];
            if (point.name.empty()) throw error(*layout_.name, "the point has no name");
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            point.position[static_cast<Index>(axis)] = read_number(layout_.coordinates[axis]);
        }
        if (layout_.time) point.time = fields[*layout_.time];
        if (layout_.temperature) point.temperature = fields[*layout_.temperature];
        list_.points.push_back(std::move(point));
    }

    double read_number(std::size_t field) const {
        const std::string_view text = csv_.fields()[field];
        const ParsedNumber number = parse_number(text);
        if (!number.ok()) {
            throw error(field,
                        fmt::format("{} {}; must be a finite number with a decimal point, or "
                                    "the point be left out",
                                    quote(text), number.problem));
        }
        const Unit& unit = unit_ != nullptr ? *unit_ : *find_unit("mm");
        const double si = unit.to_si(number.value);
        if (!is_plausible(si, Quantity::Length)) {
            throw error(field, fmt::format("{} is out of any cell; must be {}", quote(text),
                                           plausible(unit)));
        }
        return unit_ != nullptr ? si : number.value;
    }

    const std::string& path_;
    CsvReader csv_;
    const Unit* unit_;
    Layout layout_;
    PointsList list_;
};

}  // namespace

std::vector<std::string> point_unit_names() {
    std::vector<std::string> names = unit_names(Quantity::Length);
    names.emplace_back(inches.name);
    return names;
}

const Unit* find_point_unit(std::string_view name) {
    if (name == inches.name || name == "in") return &inches;
    const Unit* const unit = find_unit(name);
    return unit != nullptr && unit->quantity == Quantity::Length ? unit : nullptr;
}

bool is_points_list(const std::string& path, const std::string& content,
                    const std::vector<std::string>& joints, bool is_expected) {
    // Enough for a header; what has longer lines is none of points.
    constexpr std::size_t enough = 1 << 16;
    std::string head = content.substr(0, enough);
    if (head.size() < content.size()) head.erase(head.rfind('\n') + 1);
    CsvReader csv(path, std::move(head), CsvStyle::List);
    if (!csv.next_row()) return is_expected && content.size() <= enough;
    for (const std::string_view field : csv.fields()) {
        const std::string_view stem = split_unit(field).stem;
        if (std::ranges::find(joints, stem) != joints.end()) return false;
        if (suggest(lower(field), {"config"}).starts_with("did you mean")) return false;
    }
    if (is_expected || is_header(csv.fields())) return true;
    const Fields& fields = csv.fields();
    return fields.size() >= 3 && std::all_of(fields.end() - 3, fields.end(), is_number);
}

PointsList read_points_list(const std::string& path, std::string content, const Unit* unit) {
    return ListReader(path, std::move(content), unit).read();
}

}  // namespace posewise::detail
