#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <unordered_set>

#include "csv_reader.hpp"
#include "posewise/io/atomic_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "sample_collector.hpp"
#include "text.hpp"
#include "units.hpp"

namespace posewise::io {
namespace {

enum class Role { Configuration, Sample, Joint, Observation };

struct Column {
    Role role = Role::Sample;
    Index index = 0;             ///< of the joint or of the number in an observation
    const Unit* unit = nullptr;  ///< of joints and observations
};

/// A column with a unit that a campaign's measurements must have.
struct WantedColumn {
    std::string stem;
    Role role = Role::Joint;
    Index index = 0;
    Quantity quantity = Quantity::Angle;

    std::string example() const { return stem + (quantity == Quantity::Angle ? "_rad" : "_mm"); }
};

std::vector<WantedColumn> wanted_columns(const Campaign& campaign) {
    std::vector<WantedColumn> wanted;
    for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
        wanted.push_back({campaign.robot.joints()[static_cast<std::size_t>(j)].name, Role::Joint, j,
                          quantity_of(campaign.robot.joint_motion(j))});
    }
    Index k = 0;
    for (const std::string& name : campaign.sensor->observation_names()) {
        wanted.push_back({name, Role::Observation, k++, Quantity::Length});
    }
    return wanted;
}

/// What of a row is read: without observations their columns may be missing or hold anything.
enum class Content { JointsAndObservations, JointsOnly };

/// The columns of the header. `q1_rad` is looked up by its stem and its unit checked.
class HeaderReader {
  public:
    HeaderReader(const CsvReader& csv, const Campaign& campaign, Content content)
        : csv_(csv),
          content_(content),
          wanted_(wanted_columns(campaign)),
          examples_{"config", "sample"} {
        for (const WantedColumn& column : wanted_) examples_.push_back(column.example());
    }

    std::vector<Column> read() const {
        std::vector<Column> columns;
        for (std::size_t field = 0; field < csv_.fields().size(); ++field) {
            columns.push_back(read_column(field));
            const auto is_same = [&columns](const Column& other) {
                return other.role == columns.back().role && other.index == columns.back().index;
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

    Column read_column(std::size_t field) const {
        const std::string_view name = csv_.fields()[field];
        if (name == "config") return {Role::Configuration, 0, nullptr};
        if (name == "sample") return {Role::Sample, 0, nullptr};
        const NameWithUnit with_unit = split_unit(name);
        const auto found = std::find_if(wanted_.begin(), wanted_.end(), [&](const auto& column) {
            return column.stem == name || column.stem == with_unit.stem;
        });
        if (found == wanted_.end()) throw error(field, "is unknown; " + suggest(name, examples_));
        if (with_unit.unit == nullptr || found->stem == name) {
            throw error(field, "has no unit; must be like " + found->example());
        }
        if (with_unit.unit->quantity != found->quantity) {
            throw error(field, "has the wrong kind of unit; must be like " + found->example());
        }
        return {found->role, found->index, with_unit.unit};
    }

    void check_complete(const std::vector<Column>& columns) const {
        const auto has = [&columns](Role role, Index index) {
            return std::any_of(columns.begin(), columns.end(), [&](const Column& column) {
                return column.role == role && column.index == index;
            });
        };
        std::vector<std::string> missing;
        if (!has(Role::Configuration, 0)) missing.emplace_back("config");
        for (const WantedColumn& column : wanted_) {
            if (column.role == Role::Observation && content_ == Content::JointsOnly) continue;
            if (!has(column.role, column.index)) missing.push_back(column.example());
        }
        if (missing.empty()) return;
        throw input_error_at(csv_.locate(csv_.fields().size()),
                             fmt::format("missing column{} {}; the header must have {}",
                                         missing.size() > 1 ? "s" : "", fmt::join(missing, ", "),
                                         fmt::join(examples_, ",")));
    }

    const CsvReader& csv_;
    Content content_;
    std::vector<WantedColumn> wanted_;
    std::vector<std::string> examples_;
};

/// One row's values, in SI.
class RowReader {
  public:
    RowReader(const CsvReader& csv, const Campaign& campaign, Content content,
              std::vector<Column> columns)
        : csv_(csv),
          campaign_(campaign),
          content_(content),
          columns_(std::move(columns)),
          field_of_joint_(campaign.robot.joints().size()) {
        for (std::size_t field = 0; field < columns_.size(); ++field) {
            const Column& column = columns_[field];
            if (column.role == Role::Joint) {
                field_of_joint_[static_cast<std::size_t>(column.index)] = field;
            }
        }
        joints_.resize(campaign.robot.joint_count());
        observation_.setZero(content == Content::JointsOnly ? 0 : campaign.sensor->row_count());
    }

    void add_to(SampleCollector& samples) {
        check_width();
        sample_.clear();
        for (std::size_t field = 0; field < columns_.size(); ++field) read_field(field);
        check_new_sample();
        samples.add(id_, joints_, observation_, [this](Index joint) {
            return csv_.locate(field_of_joint_[static_cast<std::size_t>(joint)]);
        });
    }

  private:
    void check_width() const {
        const std::size_t count = csv_.fields().size();
        if (count == columns_.size()) return;
        throw input_error_at(
            csv_.locate(std::min(count, columns_.size())),
            fmt::format("row has {} fields; must have {} as the header", count, columns_.size()));
    }

    void read_field(std::size_t field) {
        const Column& column = columns_[field];
        const std::string_view text = csv_.fields()[field];
        switch (column.role) {
            case Role::Configuration:
                if (text.empty()) {
                    throw input_error_at(csv_.locate(field), "config is empty; must be an id");
                }
                id_ = text;
                return;
            case Role::Sample:
                sample_ = text;
                return;
            case Role::Joint:
                joints_[column.index] = read_number(field);
                if (column.unit->name == "rad") {
                    check_not_degrees(campaign_.robot, column.index, joints_[column.index],
                                      [this, field] { return csv_.locate(field); });
                }
                return;
            case Role::Observation:
                if (content_ == Content::JointsOnly) return;
                observation_[column.index] = read_number(field);
                return;
        }
    }

    double read_number(std::size_t field) const {
        const std::string_view text = csv_.fields()[field];
        const ParsedNumber number = parse_number(text);
        if (!number.ok()) {
            throw input_error_at(csv_.locate(field),
                                 fmt::format("{} {}; must be a finite number with a decimal "
                                             "point",
                                             quote(text), number.problem));
        }
        const Unit& unit = *columns_[field].unit;
        const double si = unit.to_si(number.value);
        if (!is_plausible(si, unit.quantity)) {
            throw input_error_at(csv_.locate(field),
                                 fmt::format("{} is out of any cell; must be {}", quote(text),
                                             plausible(unit.quantity)));
        }
        return si;
    }

    /// The same sample of the same configuration twice is a file joined with itself.
    void check_new_sample() {
        if (sample_.empty() || seen_.insert(id_ + '\n' + sample_).second) return;
        throw input_error_at(csv_.locate(0),
                             fmt::format("sample {} of configuration {} occurs twice; keep one",
                                         quote(sample_), quote(id_)));
    }

    const CsvReader& csv_;
    const Campaign& campaign_;
    Content content_;
    std::vector<Column> columns_;
    std::vector<std::size_t> field_of_joint_;
    std::unordered_set<std::string> seen_;
    std::string id_;
    std::string sample_;
    VectorXd joints_;
    VectorXd observation_;
};

Measurements read_csv(const std::string& path, const Campaign& campaign, Content content) {
    CsvReader csv(path);
    if (!csv.next_row()) {
        throw input_error_at({path},
                             "is empty; must begin with a header like "
                             "config,sample,q1_rad,...,p1_x_mm,...");
    }
    RowReader row(csv, campaign, content, HeaderReader(csv, campaign, content).read());
    SampleCollector samples(campaign,
                            content == Content::JointsOnly ? 0 : campaign.sensor->row_count());
    while (csv.next_row()) row.add_to(samples);
    return samples.finish(path);
}

}  // namespace

Measurements read_measurements_csv(const std::string& path, const Campaign& campaign) {
    return read_csv(path, campaign, Content::JointsAndObservations);
}

Configurations read_configurations_csv(const std::string& path, const Campaign& campaign) {
    Measurements read = read_csv(path, campaign, Content::JointsOnly);
    return {std::move(read.ids), std::move(read.configurations)};
}

void write_measurements_csv(const std::string& path, const Campaign& campaign,
                            const Measurements& measurements,
                            const std::vector<std::string>& comment_lines) {
    if (!measurements.configurations.allFinite() || !measurements.observations.allFinite()) {
        throw input_error_at({path},
                             "is not written, since a measurement is not a finite number; the "
                             "campaign's amounts must be smaller");
    }
    std::string text;
    const auto out = std::back_inserter(text);
    for (const std::string& line : comment_lines) {
        fmt::format_to(out, "# {}\n", escape_controls(line));
    }
    text += "config,sample";
    std::vector<double> joint_factors;  // to the unit written
    for (const WantedColumn& column : wanted_columns(campaign)) {
        text += ',' + column.example();
        if (column.role == Role::Joint) {
            joint_factors.push_back(column.quantity == Quantity::Angle ? 1 : 1e3);
        }
    }
    text += '\n';
    for (Index i = 0; i < measurements.configuration_count(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        std::string joints;
        for (Index j = 0; j < measurements.configurations.cols(); ++j) {
            fmt::format_to(
                std::back_inserter(joints), ",{}",
                measurements.configurations(i, j) * joint_factors[static_cast<std::size_t>(j)]);
        }
        for (Index sample = 0; sample < measurements.sample_count(i); ++sample) {
            fmt::format_to(out, "{},{}{}", csv_field(measurements.ids[k]), sample, joints);
            for (const double value :
                 measurements.observations.row(measurements.first_sample[k] + sample)) {
                fmt::format_to(out, ",{}", 1e3 * value);
            }
            text += '\n';
        }
    }
    write_file(path, text);
}

}  // namespace posewise::io
