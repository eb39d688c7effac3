#include "posewise/measurement/sensor.hpp"

namespace posewise {

Seen all_seen(Index pose_count, Index target_count) {
    return Seen::Constant(pose_count, target_count, true);
}

RowMatrixXd times_seen(const Seen& is_seen, double repeats) {
    return is_seen.select(RowMatrixXd::Constant(is_seen.rows(), is_seen.cols(), repeats), 0.0);
}

std::vector<Index> targets_seen(const SeenTargets& is_seen) { return seen_rows(is_seen, 1); }

SeenTargets seen_targets(const std::vector<Index>& targets, Index target_count) {
    SeenTargets is_seen = SeenTargets::Constant(target_count, false);
    for (const Index target : targets) is_seen[target] = true;
    return is_seen;
}

std::vector<Index> seen_rows(const Sensor& sensor, const SeenTargets& is_seen) {
    if (!sensor.is_combined()) return seen_rows(is_seen, sensor.rows_per_target());
    std::vector<Index> rows;
    for (const Index target : targets_seen(is_seen)) {
        for (Index row = sensor.first_row(target); row < sensor.first_row(target + 1); ++row) {
            rows.push_back(row);
        }
    }
    return rows;
}

std::vector<Index> seen_rows(const SeenTargets& is_seen, Index rows_per_target) {
    std::vector<Index> rows;
    rows.reserve(static_cast<std::size_t>(rows_per_target * is_seen.size()));
    for (Index row = 0; row < rows_per_target * is_seen.size(); ++row) {
        if (is_seen[row / rows_per_target]) rows.push_back(row);
    }
    return rows;
}

std::string target_numbers(const SeenTargets& is_seen) {
    std::string text;
    for (const Index target : targets_seen(is_seen)) {
        text += (text.empty() ? "" : " ") + std::to_string(target + 1);
    }
    return text;
}

}  // namespace posewise
