#include "trial_statement.hpp"

#include "core/names.hpp"
#include "io/format/fields.hpp"
#include "posewise/core/version.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise::detail {
namespace {

constexpr Names<const AmountUnits*, 3> error_units{
    {{&length_units, "mm"}, {&angle_units, "mrad"}, {&pixel_units, "px"}}};

void statement_fields(const Fields& file, StatedSeries& stated) {
    TrialSeries& series = stated.series;
    file("posewise_version", stated.version);
    file("simulated", series.is_simulated);
    file("campaign", series.campaign);
    file("variation", series.variation);
    file("checksum", series.checksum);
    file("seed", series.seed);
    file("criteria", series.criteria);
    file("pose_counts", series.pose_counts, Count{});
    file("random_subsets", series.random_subsets, Count{});
    file("splits", series.splits, Count{});
    file("test_count", series.test_count, Count{});
    file("ids", series.ids);
    file.optional("unit", series.units != &length_units, series.units, OneOf(error_units));
}

}  // namespace

std::string trial_statement(const TrialSeries& series, const std::string& path) {
    StatedSeries stated{std::string(version), series};
    Json statement;
    statement_fields(Fields(statement), stated);
    return json_text(statement, path);
}

StatedSeries read_trial_statement(const std::string& text, const std::string& path) {
    const Json document = Json::parse(text, nullptr, false);
    StatedSeries stated;
    statement_fields(Fields(JsonValue(document, path, "statement of a series")), stated);
    return stated;
}

}  // namespace posewise::detail
