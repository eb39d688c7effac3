#include "trial_statement.hpp"

#include "io/format/json.hpp"
#include "io/format/json_reader.hpp"
#include "posewise/core/version.hpp"

namespace posewise::detail {

std::string trial_statement(const TrialSeries& series, const std::string& path) {
    Json statement;
    statement["posewise_version"] = version;
    statement["simulated"] = series.is_simulated;
    statement["campaign"] = series.campaign;
    statement["variation"] = series.variation;
    statement["checksum"] = series.checksum;
    statement["seed"] = series.seed;
    Json& criteria = statement["criteria"] = Json::array();
    for (const Criterion criterion : series.criteria) criteria.push_back(criterion_name(criterion));
    statement["pose_counts"] = series.pose_counts;
    statement["random_subsets"] = series.random_subsets;
    statement["splits"] = series.splits;
    statement["test_count"] = series.test_count;
    statement["ids"] = series.ids;
    return json_text(statement, path);
}

StatedSeries read_trial_statement(const std::string& text, const std::string& path) {
    const Json document = Json::parse(text, nullptr, false);
    const JsonValue statement(document, path, "statement of a series");
    TrialSeries series;
    series.is_simulated = statement["simulated"].boolean();
    series.campaign = statement["campaign"].text();
    series.variation = statement["variation"].text();
    series.checksum = statement["checksum"].text();
    series.seed = statement["seed"].natural_number();
    for (const JsonValue& name : statement["criteria"].list()) {
        series.criteria.push_back(read_criterion(name));
    }
    for (const JsonValue& count : statement["pose_counts"].list()) {
        series.pose_counts.push_back(count.count(0));
    }
    series.random_subsets = statement["random_subsets"].count(0);
    series.splits = statement["splits"].count(0);
    series.test_count = statement["test_count"].count(0);
    series.ids = statement["ids"].texts();
    return {statement["posewise_version"].text(), std::move(series)};
}

}  // namespace posewise::detail
