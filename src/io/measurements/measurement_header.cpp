#include "measurement_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "io/format/text.hpp"
#include "io/format/units.hpp"

namespace posewise::detail {
namespace {

constexpr std::array<std::pair<std::string_view, Role>, 3> corner_roles{
    {{point_column, Role::Point}, {camera_column, Role::Camera}, {sensor_column, Role::Sensor}}};

/// The columns of the header. `q1_rad` is looked up by its stem and its unit checked.
class HeaderReader {
  public:
    HeaderReader(const CsvReader& csv, const Campaign& campaign, Content content)
        : csv_(csv),
          content_(content),
          joints_(campaign.robot.joints()),
          form_(form_of(csv, campaign, content)),
          wanted_(wanted_columns(campaign, form_)),
          has_orientation_(campaign.sensor->has_orientation()),
          has_contact_(campaign.sensor->has_contacts()),
          target_count_(campaign.sensor->target_count()),
          of_corners_(form_ == Form::RowEachCorner ? corner_columns(*campaign.sensor)
                                                   : std::vector<std::string_view>()),
          examples_{"config"} {
        if (!is_optional(Role::Sample)) examples_.emplace_back("sample");
        for (const WantedColumn& column : wanted_) {
            if (!is_optional(column.role)) examples_.push_back(column.example());
        }
        if (has_contact_) examples_.emplace_back(contact);
        examples_.insert(examples_.end(), of_corners_.begin(), of_corners_.end());
    }

    Header read() const {
        Header header;
        std::vector<Column>& columns = header.columns;
        std::vector<std::size_t> unknown;
        for (std::size_t field = 0; field < csv_.fields().size(); ++field) {
            const std::optional<Column> column = read_column(field);
            if (!column) {
                if (content_ != Content::JointsAndObservations) throw unknown_error(field);
                unknown.push_back(field);
                // Each is one by itself, whatever its name.
                const Index beyond = std::ssize(joints_) + written_count;
                columns.push_back({Role::Unused, beyond + static_cast<Index>(field)});
                continue;
            }
            columns.push_back(*column);
            const auto is_same = [&columns](const Column& other) {
                return other.role == columns.back().role && other.index == columns.back().index &&
                       other.form == columns.back().form;
            };
            if (std::any_of(columns.begin(), columns.end() - 1, is_same)) {
                throw error(field, "occurs twice; keep one");
            }
        }
        check_complete(columns, unknown);
        check_unknown(columns, unknown);
        for (const std::size_t field : unknown) header.unused.emplace_back(csv_.fields()[field]);
        return header;
    }

  private:
    /// Of pixels: a row a corner, unless columns of the first corners say otherwise.
    static Form form_of(const CsvReader& csv, const Campaign& campaign, Content content) {
        if (!campaign.sensor->has_only_pixels() || content != Content::JointsAndObservations) {
            return Form::RowEachSample;
        }
        const auto names = campaign.sensor->observation_names();
        const bool is_wide = std::ranges::any_of(csv.fields(), [&](const auto& field) {
            return std::ranges::find(names, split_unit(field).stem) != names.end();
        });
        return is_wide ? Form::RowEachSample : Form::RowEachCorner;
    }

    InputError error(std::size_t field, const std::string& problem) const {
        return input_error_at(csv_.locate(field),
                              "column " + quote(csv_.fields()[field]) + " " + problem);
    }

    /// What configurations need not state.
    bool is_optional(Role role) const {
        return content_ != Content::JointsAndObservations &&
               (role == Role::Sample || role == Role::Observation);
    }

    static constexpr std::array by_plan{way_column, clearance_column, nearest_column};
    static constexpr Index written_count = std::ssize(by_plan) + std::ssize(correction_columns);

    InputError unknown_error(std::size_t field) const {
        std::vector<std::string> known = examples_;
        if (is_optional(Role::Sample)) known.emplace_back("sample");
        if (!has_contact_) known.emplace_back(visible_targets);
        return error(
            field, "is unknown" + count_known(field) + "; " + suggest(csv_.fields()[field], known));
    }

    /// ", the campaign states 1 target" for p2_x_mm, ", its robot has 6 joints" for q7_deg: files
    /// of another campaign.
    std::string count_known(std::size_t field) const {
        const std::string_view name = csv_.fields()[field];
        if (name.size() < 2 || (name[0] != 'p' && name[0] != 'q')) return "";
        Index number = 0;
        const auto [end, problem] =
            std::from_chars(name.data() + 1, name.data() + name.size(), number);
        const bool is_target = name[0] == 'p';
        const Index count = is_target ? target_count_ : std::ssize(joints_);
        if (problem != std::errc() || end == name.data() + name.size() || *end != '_' ||
            number <= count)
            return "";
        return is_target ? ", the campaign states " + count_of(count, "target")
                         : ", the campaign's robot has " + count_of(count, "joint");
    }

    /// Nothing: it is unknown.
    std::optional<Column> read_column(std::size_t field) const {
        const std::string_view name = csv_.fields()[field];
        if (name == "config") return Column{Role::Configuration};
        if (name == "sample") return Column{Role::Sample};
        if (name == visible_targets && !has_contact_) return Column{Role::VisibleTargets};
        if (name == purpose_column) return Column{Role::Purpose};
        if (name == contact && has_contact_) return Column{Role::Contact};
        for (const auto& [of_corner, role] : corner_roles) {
            if (name == of_corner && form_ == Form::RowEachCorner) return Column{role};
        }
        if (content_ == Content::JointsAndObservations) {
            if (name == time_column || name == time_seconds_column) return Column{Role::Time};
            if (name == temperature_column) return Column{Role::Temperature};
        }
        const NameWithUnit with_unit = split_unit(name);
        const auto found = std::find_if(wanted_.begin(), wanted_.end(), [&](const auto& column) {
            return column.stem == name || column.stem == with_unit.stem;
        });
        if (found == wanted_.end() && has_orientation_) {
            if (const auto column = find_orientation(field, with_unit)) return column;
            if (const auto column = find_ros_position(field, with_unit)) return column;
        }
        if (found == wanted_.end()) {
            auto unused = find_unused_torque(with_unit);
            if (!unused) unused = find_written(name);
            if (!unused) return std::nullopt;
            return Column{Role::Unused, *unused, with_unit.unit};
        }
        if (with_unit.unit == nullptr || found->stem == name) {
            throw error(field, "has no unit; must be like " + found->example());
        }
        if (with_unit.unit->quantity != found->quantity) {
            throw error(field, "has the wrong kind of unit; must be like " + found->example());
        }
        return Column{found->role, found->index, with_unit.unit};
    }

    /// A pose's x, y or z under its other name.
    std::optional<Column> find_ros_position(std::size_t field, const NameWithUnit& name) const {
        const auto found = std::ranges::find(ros_position, name.stem);
        if (found == ros_position.end()) return std::nullopt;
        const Unit* const unit = name.unit != nullptr ? name.unit : find_unit("m");
        if (unit->quantity != Quantity::Length) {
            throw error(field,
                        fmt::format("has the wrong kind of unit; must be like {}_mm", *found));
        }
        return Column{Role::Observation, found - ros_position.begin(), unit, 0,
                      name.unit == nullptr};
    }

    /// The joint of a torque that the campaign does not ask for.
    std::optional<Index> find_unused_torque(const NameWithUnit& name) const {
        if (name.unit == nullptr || name.unit->quantity != Quantity::Torque) return std::nullopt;
        const auto found = std::find_if(joints_.begin(), joints_.end(), [&](const Joint& joint) {
            return torque_stem(joint) == name.stem;
        });
        return found == joints_.end() ? std::nullopt : std::optional(found - joints_.begin());
    }

    /// The number of what plan or correct writes beside the joints, counted behind these.
    std::optional<Index> find_written(std::string_view name) const {
        const auto planned = std::find(by_plan.begin(), by_plan.end(), name);
        Index number = std::ssize(joints_) + (planned - by_plan.begin());
        if (planned != by_plan.end()) return number;
        if (content_ == Content::JointsAndObservations) return std::nullopt;
        const auto found = std::find(correction_columns.begin(), correction_columns.end(), name);
        if (found == correction_columns.end()) return std::nullopt;
        return number + (found - correction_columns.begin());
    }

    /// A column of another form of an orientation.
    std::optional<Column> find_orientation(std::size_t field, const NameWithUnit& name) const {
        for (std::size_t form = 0; form < orientation_forms.size(); ++form) {
            const auto& [stems, has_unit, notation] = orientation_forms[form];
            const auto found = std::find(stems.begin(), stems.end(), name.stem);
            if (found == stems.end()) continue;
            const bool is_angle = name.unit != nullptr && name.unit->quantity == Quantity::Angle;
            if (has_unit && !is_angle) {
                throw error(field, "has no unit of angle; must be like " + *found + "_deg");
            }
            if (!has_unit && name.unit != nullptr) throw error(field, "must have no unit");
            return Column{Role::Orientation, found - stems.begin(), name.unit, form};
        }
        return std::nullopt;
    }

    /// Whether all columns of one form stand in for the rotation vector. Throws if there are some
    /// of it only, or others beside it.
    bool has_form(const std::vector<Column>& columns) const {
        const auto first = std::find_if(columns.begin(), columns.end(), [](const Column& column) {
            return column.role == Role::Orientation;
        });
        if (first == columns.end()) return false;
        const auto& stems = orientation_forms[first->form].stems;
        const auto count = std::count_if(columns.begin(), columns.end(), [&](const Column& column) {
            return column.role == Role::Orientation && column.form == first->form;
        });
        const bool has_others = std::any_of(columns.begin(), columns.end(), [&](const Column& c) {
            return (c.role == Role::Orientation && c.form != first->form) ||
                   (c.role == Role::Observation && c.index >= 3);
        });
        if (count == static_cast<std::ptrdiff_t>(stems.size()) && !has_others) return true;
        throw error(static_cast<std::size_t>(first - columns.begin()),
                    fmt::format("is one of {}; must come with all of them and no other orientation",
                                fmt::join(stems, ", ")));
    }

    void check_complete(const std::vector<Column>& columns,
                        const std::vector<std::size_t>& unknown) const {
        const bool is_replaced = has_form(columns);
        const auto has = [&columns](Role role, Index index) {
            return std::any_of(columns.begin(), columns.end(), [&](const Column& column) {
                return column.role == role && column.index == index;
            });
        };
        std::vector<std::string> missing;
        if (!has(Role::Configuration, 0)) missing.emplace_back("config");
        for (const WantedColumn& column : wanted_) {
            if (is_optional(column.role)) continue;
            if (is_replaced && column.role == Role::Observation && column.index >= 3) continue;
            if (!has(column.role, column.index)) missing.push_back(column.example());
        }
        if (has_contact_ && content_ != Content::Program && !has(Role::Contact, 0)) {
            missing.emplace_back(contact);
        }
        for (const auto& [name, role] : corner_roles) {
            const bool is_needed = std::ranges::find(of_corners_, name) != of_corners_.end();
            if (is_needed && !has(role, 0)) missing.emplace_back(name);
        }
        if (missing.empty()) return;
        for (const std::size_t field : unknown) {
            if (is_near(field, missing)) throw unknown_error(field);
        }
        std::vector<std::string> others;
        for (const std::size_t field : unknown) others.push_back(quote(csv_.fields()[field]));
        throw input_error_at(
            csv_.locate(csv_.fields().size()),
            fmt::format("missing column{} {}; the header must have {}{}{}",
                        missing.size() > 1 ? "s" : "", fmt::join(missing, ", "),
                        fmt::join(examples_, ","), others.empty() ? "" : ", and does not need ",
                        list_words(others)));
    }

    bool is_near(std::size_t field, const std::vector<std::string>& names) const {
        return suggest(csv_.fields()[field], names).starts_with("did you mean");
    }

    /// Of another campaign, or nearly a column that need not be there and is not.
    void check_unknown(const std::vector<Column>& columns,
                       const std::vector<std::size_t>& unknown) const {
        std::vector<std::string> absent;
        const auto add = [&](Role role, std::string_view name) {
            if (std::ranges::find(columns, role, &Column::role) == columns.end()) {
                absent.emplace_back(name);
            }
        };
        add(Role::Sample, "sample");
        add(Role::Purpose, purpose_column);
        if (!has_contact_) add(Role::VisibleTargets, visible_targets);
        for (const std::size_t field : unknown) {
            if (!count_known(field).empty()) throw unknown_error(field);
            if (is_near(field, absent)) {
                throw error(field, "is unknown; " + suggest(csv_.fields()[field], absent));
            }
        }
    }

    const CsvReader& csv_;
    Content content_;
    const std::vector<Joint>& joints_;
    Form form_;
    std::vector<WantedColumn> wanted_;
    bool has_orientation_;
    bool has_contact_;
    Index target_count_;
    std::vector<std::string_view> of_corners_;  ///< columns by which a row of one corner names it
    std::vector<std::string> examples_;
};

}  // namespace

Header read_header(const CsvReader& csv, const Campaign& campaign, Content content) {
    return HeaderReader(csv, campaign, content).read();
}

}  // namespace posewise::detail
