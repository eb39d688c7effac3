#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.hpp"
#include "core/text.hpp"
#include "measurement/noise.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/study.hpp"
#include "simulation_setting.hpp"
#include "study_cases.hpp"
#include "trial_robot.hpp"

namespace posewise {
namespace {

using detail::draw_seed;
using detail::SimulationSetting;
using detail::Subset;
using detail::TrialRobot;

// ---- One trial ----

/// What the calibration expects at the test configurations, m.
double expected_there(const SimulationSetting& setting, const Estimate& estimate) {
    const double parameters = setting.H.cwiseProduct(estimate.covariance).sum();
    const double factor = setting.campaign.spread.is_prior ? 1 : estimate.variance_factor;
    const double left_over = with_model_error(setting.campaign, estimate).model_error;
    return std::sqrt(parameters + factor * 3 * left_over * left_over);
}

StudyCase run_case(const SimulationSetting& setting, const SimulatedStudyOptions& options,
                   const TrialRobot& trial, const Subset& subset, std::uint64_t seed) {
    StudyCase result;
    if (subset.configurations.rows() == 0) return result;
    const auto estimate =
        detail::calibrate_robot(setting.campaign, trial, subset, options.repeats, seed);
    if (!estimate) return result;
    result.held_out = detail::compare_positions(
        detail::target_positions(setting.campaign, estimate->parameters, setting.test),
        trial.positions);
    result.expected = expected_there(setting, *estimate);
    result.identified = true;
    return result;
}

std::vector<double> run_trial(const SimulationSetting& setting,
                              const SimulatedStudyOptions& options, Index number) {
    RandomStream stream(options.seed.value(), static_cast<std::uint64_t>(number));
    DrawnRobot robot = draw_robot(setting.truth, draw_seed(stream));
    const TrialRobot trial =
        detail::visit(setting.truth, std::move(robot), setting.test, draw_seed(stream));
    const std::uint64_t noise = draw_seed(stream);
    const std::uint64_t choices = draw_seed(stream);
    std::vector<double> values;
    for (std::size_t k = 0; k < setting.planned.size(); ++k) {
        const Index count = setting.series.pose_counts[k];
        // Each count's numbers depend on it and not on which others there are.
        const std::uint64_t seed = noise + static_cast<std::uint64_t>(count);
        for (const Subset& subset : setting.planned[k]) {
            detail::append_case(run_case(setting, options, trial, subset, seed), values);
        }
        RandomStream random(choices, static_cast<std::uint64_t>(count));
        for (Index r = 0; r < options.random_subsets; ++r) {
            const Subset subset = detail::take(
                setting.pool, random.subset(setting.pool.configurations.rows(), count));
            const std::uint64_t own = ~seed + static_cast<std::uint64_t>(r);
            detail::append_case(run_case(setting, options, trial, subset, own), values);
        }
    }
    return values;
}

// ---- What comes of the trials ----

/// As part of the ratio.
double half_width(const Advantage& advantage) {
    return (advantage.upper - advantage.lower) / 2 / advantage.ratio;
}

/// Half of the 95 % interval of a geometric mean, as part of it; infinity where it is not known.
double relative_half_width(const Study& study, const StudyRow& row, std::size_t criterion) {
    constexpr double unknown = std::numeric_limits<double>::infinity();
    if (!row.random.empty()) {
        const auto advantage = planned_advantage(study, row, criterion);
        if (!advantage || row.optimal.size() <= study.criteria.size()) return unknown;
        return half_width(*advantage);
    }
    const StudyCases planned = planned_cases(row, criterion, study.criteria.size());
    const auto mean = detail::geometric_mean([&](const std::function<void(double)>& visitor) {
        for (const StudyCase& found : planned) {
            visitor(found.identified ? std::log(found.held_out.rms)
                                     : std::numeric_limits<double>::quiet_NaN());
        }
    });
    return mean && planned.size() > 1 ? half_width(*mean) : unknown;
}

bool is_precise(const Study& study, double precision) {
    for (const StudyRow& row : study.rows) {
        for (std::size_t c = 0; c < study.criteria.size(); ++c) {
            if (relative_half_width(study, row, c) > precision) return false;
        }
    }
    return true;
}

/// Throws InputError for variations of which nothing comes.
void check_differences(const std::vector<TrialSeries>& series) {
    for (std::size_t s = 0; s < series.size(); ++s) {
        for (std::size_t other = 0; other < s; ++other) {
            if (series[s].checksum != series[other].checksum) continue;
            throw InputError(fmt::format(
                "{} and {} are the same study: what was varied changes no robot, pool or "
                "measurement; must be left out (criteria and seed are options, not keys)",
                detail::quote(series[other].variation), detail::quote(series[s].variation)));
        }
    }
}

/// Runs trials of each series until there are enough.
void run_trials(const std::vector<TrialSeries>& series, const SimulatedStudyOptions& options,
                const RunTrials& run, detail::TrialRuns& runs) {
    constexpr Index first = 50;
    const bool is_adaptive = options.precision > 0;
    std::vector<Index> counts(series.size(),
                              is_adaptive ? std::min(first, options.trials) : options.trials);
    runs.run(run, counts);
    for (bool is_open = is_adaptive; is_open && !options.stop.is_set();) {
        is_open = false;
        for (std::size_t s = 0; s < series.size(); ++s) {
            if (counts[s] == options.trials) continue;
            // A store may have more.
            if (is_precise(runs.study_of_first(s, counts[s]), options.precision)) continue;
            counts[s] = std::min(options.trials, counts[s] + std::max<Index>(first, counts[s] / 2));
            is_open = true;
        }
        if (is_open) runs.run(run, counts);
    }
}

}  // namespace

std::vector<Study> simulate_study(const std::vector<SimulatedCampaign>& campaigns,
                                  const SimulatedStudyOptions& asked) {
    if (campaigns.empty()) return {};
    SimulatedStudyOptions options = asked;
    detail::complete(options, campaigns.front().campaign);
    detail::check_simulation(options);
    std::vector<SimulationSetting> settings;
    std::vector<TrialSeries> series;
    for (const SimulatedCampaign& campaign : campaigns) {
        settings.push_back(detail::make_setting(campaign, options));
        series.push_back(settings.back().series);
    }
    const auto compute = [&](const TrialId& id) {
        return run_trial(settings[static_cast<std::size_t>(id.series)], options, id.number);
    };
    check_differences(series);
    std::vector<Study> studies;
    options.crew(compute, [&](const RunTrials& run) {
        detail::TrialRuns runs(series, options);
        run_trials(series, options, run, runs);
        for (std::size_t s = 0; s < series.size(); ++s) {
            Study& study = studies.emplace_back(runs.study_of_all(s));
            const bool is_enough = options.precision == 0 || is_precise(study, options.precision);
            study.ending =
                options.stop.ending_or(is_enough ? Ending::Converged : Ending::IterationLimit);
        }
        const auto is_empty = [](const Study& study) { return study.rows.empty(); };
        if (!std::ranges::all_of(studies, is_empty)) std::erase_if(studies, is_empty);
    });
    return studies;
}

}  // namespace posewise
