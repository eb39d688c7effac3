#include "measurement_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "io/format/text.hpp"
#include "io/format/units.hpp"

namespace posewise::detail {
namespace {

/// The columns of the header. `q1_rad` is looked up by its stem and its unit checked.
class HeaderReader {
  public:
    HeaderReader(const CsvReader& csv, const Campaign& campaign, Content content)
        : csv_(csv),
          content_(content),
          joints_(campaign.robot.joints()),
          wanted_(wanted_columns(campaign)),
          has_orientation_(campaign.sensor->has_orientation()),
          has_contact_(campaign.sensor->has_contacts()),
          target_count_(campaign.sensor->target_count()),
          examples_{"config"} {
        if (!is_optional(Role::Sample)) examples_.emplace_back("sample");
        for (const WantedColumn& column : wanted_) {
            if (!is_optional(column.role)) examples_.push_back(column.example());
        }
        if (has_contact_) examples_.emplace_back(contact);
    }

    std::vector<Column> read() const {
        std::vector<Column> columns;
        for (std::size_t field = 0; field < csv_.fields().size(); ++field) {
            columns.push_back(read_column(field));
            const auto is_same = [&columns](const Column& other) {
                return other.role == columns.back().role && other.index == columns.back().index &&
                       other.form == columns.back().form;
            };
            if (std::any_of(columns.begin(), columns.end() - 1, is_same)) {
                throw error(field, "occurs twice; keep one");
            }
        }
        check_complete(columns);
        return columns;
    }

  private:
    InputError error(std::size_t field, const std::string& problem) const {
        return input_error_at(csv_.locate(field),
                              "column " + quote(csv_.fields()[field]) + " " + problem);
    }

    /// What configurations need not state.
    bool is_optional(Role role) const {
        return content_ != Content::JointsAndObservations &&
               (role == Role::Sample || role == Role::Observation);
    }

    InputError unknown(std::size_t field) const {
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

    Column read_column(std::size_t field) const {
        const std::string_view name = csv_.fields()[field];
        if (name == "config") return {Role::Configuration, 0, nullptr};
        if (name == "sample") return {Role::Sample, 0, nullptr};
        if (name == visible_targets && !has_contact_) return {Role::VisibleTargets, 0, nullptr};
        if (name == purpose_column) return {Role::Purpose, 0, nullptr};
        if (name == contact && has_contact_) return {Role::Contact, 0, nullptr};
        const NameWithUnit with_unit = split_unit(name);
        const auto found = std::find_if(wanted_.begin(), wanted_.end(), [&](const auto& column) {
            return column.stem == name || column.stem == with_unit.stem;
        });
        if (found == wanted_.end() && has_orientation_) {
            if (const auto column = find_orientation(field, with_unit)) return *column;
        }
        if (found == wanted_.end()) {
            auto unused = find_unused_torque(with_unit);
            if (!unused) unused = find_written(name);
            if (!unused) throw unknown(field);
            return {Role::Unused, *unused, with_unit.unit};
        }
        if (with_unit.unit == nullptr || found->stem == name) {
            throw error(field, "has no unit; must be like " + found->example());
        }
        if (with_unit.unit->quantity != found->quantity) {
            throw error(field, "has the wrong kind of unit; must be like " + found->example());
        }
        return {found->role, found->index, with_unit.unit};
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
        constexpr std::array by_plan{way_column, clearance_column, nearest_column};
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

    void check_complete(const std::vector<Column>& columns) const {
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
        if (missing.empty()) return;
        throw input_error_at(csv_.locate(csv_.fields().size()),
                             fmt::format("missing column{} {}; the header must have {}",
                                         missing.size() > 1 ? "s" : "", fmt::join(missing, ", "),
                                         fmt::join(examples_, ",")));
    }

    const CsvReader& csv_;
    Content content_;
    const std::vector<Joint>& joints_;
    std::vector<WantedColumn> wanted_;
    bool has_orientation_;
    bool has_contact_;
    Index target_count_;
    std::vector<std::string> examples_;
};

}  // namespace

std::vector<Column> read_header(const CsvReader& csv, const Campaign& campaign, Content content) {
    return HeaderReader(csv, campaign, content).read();
}

}  // namespace posewise::detail
