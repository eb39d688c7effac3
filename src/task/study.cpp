#include "posewise/task/study.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "../core/parallel.hpp"
#include "../core/progress_counter.hpp"
#include "../core/statistics.hpp"
#include "inputs.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/jacobian/identifiability.hpp"
#include "posewise/selection/exchange.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise {
namespace {

/// What every case of a study shares.
struct Setting {
    const Campaign& campaign;
    const Measurements& measurements;
    const StudyOptions& options;
    Blocks blocks;  ///< of all configurations, at the registered parameters
};

/// One subset to be chosen, calibrated with and judged; cases are independent of each other.
struct Job {
    Index pose_count = 0;
    StudyCase* result = nullptr;
    bool is_random = false;
    std::size_t number = 0;  ///< which criterion, or which random subset
};

/// Why not even all configurations identify the model; empty: they do.
std::string describe_undetermined(const Campaign& campaign, const Measurements& measurements,
                                  const Registration& registration) {
    if (!registration.is_determined()) return registration.undetermined;
    return identify(campaign, measurements, registration.parameters).undetermined;
}

void check_options(const StudyOptions& options) {
    if (options.random_subsets >= 0 && options.starts >= 1) return;
    throw InputError("random subsets and starts must be at least 0 and 1, are " +
                     std::to_string(options.random_subsets) + " and " +
                     std::to_string(options.starts));
}

std::vector<Index> choose_pose_counts(const Campaign& campaign, const Measurements& measurements,
                                      const std::vector<Index>& asked) {
    const Index all = measurements.configuration_count();
    for (const Index count : asked) {
        if (count < 1 || count > all) {
            throw InputError("a pose count is " + std::to_string(count) +
                             ", must be from 1 to the number of configurations, " +
                             std::to_string(all));
        }
    }
    if (!asked.empty()) return asked;
    const Index least = least_pose_count(campaign);
    std::vector<Index> counts;
    for (Index count = least; count < all; ++count) counts.push_back(count);
    if (counts.empty()) {
        throw InputError("there are " + std::to_string(all) + " configurations, a study needs " +
                         std::to_string(least + 1) +
                         ": as many as identify the model and one to judge on");
    }
    return counts;
}

/// None if no choice identifies the model.
std::vector<Index> choose_poses(const Setting& setting, const Job& job) {
    const Index all = setting.blocks.count();
    if (job.is_random) {
        // The stream depends on size and number only, so more subsets or sizes change no other.
        const auto item = (static_cast<std::uint64_t>(job.pose_count) << 32) + job.number;
        return RandomStream(setting.options.seed, item).subset(all, job.pose_count);
    }
    SelectOptions options;
    options.criterion = setting.options.criteria[job.number];
    options.pose_count = job.pose_count;
    options.starts = setting.options.starts;
    if (setting.campaign.spread.is_prior) options.held = prior_information(setting.campaign);
    options.seed = setting.options.seed;
    return select_poses(setting.blocks, options).poses;
}

/// Leaves the case "not identified" if its poses cannot be found or do not identify the model:
/// that is what a study is to show.
void run(const Setting& setting, const Job& job) {
    StudyCase& result = *job.result;
    result.poses = choose_poses(setting, job);
    if (result.poses.empty()) return;
    const Measurements& measurements = setting.measurements;
    const Measurements chosen = take(measurements, result.poses);
    const Registration start = register_base_and_targets(setting.campaign, chosen);
    if (!start.is_determined()) return;
    const Estimate estimate = identify(setting.campaign, chosen, start.parameters);
    if (estimate.ending == Ending::NotIdentifiable) return;
    const auto left_out = all_but(measurements.configuration_count(), result.poses);
    if (!left_out.empty()) {
        result.held_out = make_metrics(
            mean_residuals(setting.campaign, estimate.parameters, take(measurements, left_out)),
            setting.campaign.sensor->lengths_per_target());
    }
    result.identified = true;
}

/// The cases of all rows; pointers into `rows`, which must not be resized any more.
std::vector<Job> list_jobs(std::vector<StudyRow>& rows) {
    std::vector<Job> jobs;
    for (StudyRow& row : rows) {
        for (std::size_t i = 0; i < row.optimal.size(); ++i) {
            jobs.push_back({row.pose_count, &row.optimal[i], false, i});
        }
        for (std::size_t i = 0; i < row.random.size(); ++i) {
            jobs.push_back({row.pose_count, &row.random[i], true, i});
        }
    }
    return jobs;
}

std::vector<StudyRow> make_rows(const std::vector<Index>& counts, const StudyOptions& options) {
    std::vector<StudyRow> rows;
    for (const Index count : counts) {
        StudyRow row;
        row.pose_count = count;
        row.optimal.resize(options.criteria.size());
        row.random.resize(static_cast<std::size_t>(options.random_subsets));
        rows.push_back(std::move(row));
    }
    return rows;
}

/// Runs all cases; of a study that is stopped, those rows stay that are complete.
void run_all(const Setting& setting, std::vector<StudyRow>& rows) {
    const std::vector<Job> jobs = list_jobs(rows);
    std::vector<char> is_done(jobs.size(), 0);
    const auto count = static_cast<Index>(jobs.size());
    detail::ProgressCounter counter(setting.options.progress, count);
    detail::for_each_index(count, [&](Index i) {
        if (setting.options.stop.is_set()) return;
        const auto k = static_cast<std::size_t>(i);
        run(setting, jobs[k]);
        is_done[k] = 1;
        counter.count();
    });
    std::set<Index> open;
    for (std::size_t k = 0; k < jobs.size(); ++k) {
        if (is_done[k] == 0) open.insert(jobs[k].pose_count);
    }
    std::erase_if(rows, [&](const StudyRow& row) { return open.contains(row.pose_count); });
}

}  // namespace

Study study(const Campaign& campaign, const Measurements& measurements,
            const StudyOptions& options) {
    const Registration registration = register_base_and_targets(campaign, measurements);
    check_is_of_robot(campaign, measurements, registration);
    check_options(options);
    const auto counts = choose_pose_counts(campaign, measurements, options.pose_counts);
    Study study{campaign.name, measurements.ids, options.criteria, {}, Ending::NotIdentifiable, {}};
    study.undetermined = describe_undetermined(campaign, measurements, registration);
    if (!study.undetermined.empty()) return study;
    const Setting setting{campaign, measurements, options,
                          detail::measured_blocks(campaign, registration.parameters, measurements)};
    study.rows = make_rows(counts, options);
    run_all(setting, study.rows);
    study.ending = options.stop.ending_or(Ending::Converged);
    return study;
}

std::optional<double> held_out_quantile(const std::vector<StudyCase>& cases, double p) {
    constexpr double worst = std::numeric_limits<double>::infinity();
    std::vector<double> errors;
    for (const StudyCase& study_case : cases) {
        if (!study_case.identified) {
            errors.push_back(worst);
        } else if (study_case.held_out.point_count > 0) {
            errors.push_back(study_case.held_out.distance_rms);
        }
    }
    if (errors.empty()) return std::nullopt;
    const double error =
        quantile(Eigen::Map<const VectorXd>(errors.data(), static_cast<Index>(errors.size())),
                 std::clamp(p, 0.0, 1.0), detail::QuantileRule::Linear);
    if (error == worst) return std::nullopt;
    return error;
}

}  // namespace posewise
