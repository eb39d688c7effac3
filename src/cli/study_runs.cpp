#include "study_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "crew.hpp"
#include "files.hpp"
#include "io/format/atomic_file.hpp"
#include "measured.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/report/reports.hpp"

namespace posewise::cli {
namespace {

/// "12.3 trials/s, about 7 s left".
class RateNote {
  public:
    std::string operator()(const Progress& state) const {
        using Seconds = std::chrono::duration<double>;
        if (first_ < 0) first_ = state.done - 1;
        const double elapsed = Seconds(std::chrono::steady_clock::now() - begin_).count();
        const double rate = static_cast<double>(state.done - first_) / std::max(elapsed, 1e-6);
        return fmt::format("{:.3g} trials/s, about {:.0f} s left", rate,
                           static_cast<double>(state.total - state.done) / rate);
    }

  private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    mutable Index first_ = -1;  ///< done before, and kept in a store
};

/// The campaign as its file says, or with each of the error models asked for.
std::vector<io::CampaignFile> read_files(const StudyArguments& arguments) {
    const std::string& path = arguments.paths.campaign;
    if (arguments.models.empty()) {
        io::CampaignFile file = read_with_prior(path, arguments.prior);
        expect_earlier(file, arguments.earlier);
        return {file};
    }
    std::vector<io::CampaignFile> files = io::read_campaign(path, arguments.models);
    for (io::CampaignFile& file : files) {
        io::set_prior(file, arguments.prior);
    }
    return files;
}

std::vector<RobotModel> list_models(const std::vector<io::CampaignFile>& files) {
    std::vector<RobotModel> models;
    for (const io::CampaignFile& file : files) {
        models.push_back({std::string(io::error_model_name(file.error_model)), file});
    }
    return models;
}

/// What both kinds of study have in common.
void complete_options(StudyOptions& options, const StudyArguments& arguments,
                      const StopSignal& stop) {
    options.seed = arguments.seed;
    if (!arguments.criteria.empty()) options.criteria = arguments.criteria;
    options.least_distance = to_radians(arguments.least_distance_deg);
    options.stop = stop;
    options.crew = trial_crew();
    if (!arguments.store.empty() && leads_crew()) {
        options.store = io::open_trial_store(arguments.store);
    }
}

/// The campaign as it is, or with each combination of what is varied.
std::vector<SimulatedCampaign> list_variations(const StudyArguments& arguments,
                                               const io::CampaignFile& file,
                                               const StopSignal& stop) {
    std::optional<Campaign> truth;
    if (!arguments.truth.empty()) truth = io::read_campaign(arguments.truth);
    if (arguments.varied.empty() && arguments.points == 0) return {{"", file, truth}};
    std::vector<io::VariedKey> keys;
    for (const std::string& text : arguments.varied) {
        keys.push_back(compute_from("--vary", [&] { return io::parse_varied_key(text); }));
    }
    const std::string& path = file.path;
    std::vector<SimulatedCampaign> campaigns;
    const auto variations = compute_from("--vary", [&] {
        return io::vary_campaign(detail::read_file(path), path, keys, arguments.points);
    });
    for (const io::Variation& variation : variations) {
        stop.check("variations were read");
        // Lines of the text that was varied are not those of the file.
        io::CampaignFile varied = compute_from("--vary " + variation.name, [&] {
            return io::parse_campaign(variation.content, path);
        });
        io::set_prior(varied, arguments.prior);
        if (!arguments.earlier.from.empty()) {  // what is to be warned of has been
            static_cast<Campaign&>(varied) = compute_from("--vary " + variation.name, [&] {
                const EarlierUse use = arguments.earlier.use();
                const std::string& from = arguments.earlier.from;
                const Earlier earlier = io::read_earlier(from, varied, use);
                return compute_from(from, [&] { return with_earlier(varied, earlier); });
            });
        }
        campaigns.push_back({variation.name, varied, truth});
    }
    return campaigns;
}

/// Studies that one table can show.
bool belong_together(const Study& a, const Study& b) {
    const auto counts = [](const Study& study) {
        std::vector<Index> all;
        for (const StudyRow& row : study.rows) all.push_back(row.pose_count);
        return all;
    };
    return a.campaign == b.campaign && a.criteria == b.criteria && counts(a) == counts(b) &&
           a.is_simulated == b.is_simulated && (a.splits > 0) == (b.splits > 0);
}

}  // namespace

void check_study_outputs(const StudyArguments& arguments,
                         const std::vector<const io::CampaignFile*>& campaigns,
                         std::vector<std::string> inputs, const CommonOptions& common) {
    const std::vector<std::string> outputs{arguments.csv, arguments.plot, arguments.page};
    // The store of a run is read and written; others that are there already were not made in vain.
    inputs.push_back(arguments.store);
    check_outputs(campaigns, std::move(inputs), outputs, common);
    for (const std::string& path : outputs) {
        if (!io::is_trial_store(path)) continue;
        throw input_error_at({path}, "is a store of trials; must be another file");
    }
}

std::vector<Study> study_measured(const StudyArguments& arguments, const CommonOptions& common,
                                  const StopSignal& stop, StudyExtras& extras) {
    const InputPaths& paths = arguments.paths;
    const std::vector<io::CampaignFile> files = read_files(arguments);
    const io::CampaignFile& file = files.front();
    check_study_outputs(arguments, {&file},
                        {paths.measurements, paths.plan, arguments.earlier.from}, common);
    const MeasuredPlans plans = read_measured_plans(paths, file);
    const auto measurements =
        read_measured_without(arguments.excluded, paths, file, arguments.earlier, plans);
    check_needs_unit(paths, measurements.is_joined);
    check_needs_plan(paths, measurements.is_joined);
    StudyOptions options = arguments.options;
    options.random_subsets = arguments.random_subsets.value_or(StudyOptions().random_subsets);
    complete_options(options, arguments, stop);
    options.judge = judge_of(paths.measurements, arguments.earlier.is_forced);
    ProgressLine line("calibrating", arguments.progress);
    options.progress = [&](const Progress& progress) { line(progress); };
    extras.notes = describe_earlier(arguments.earlier) + describe_unused_planning(file);
    if (!arguments.page.empty()) {
        extras.page.configurations = {measurements.ids, measurements.configurations};
        extras.page.scene =
            compute_from(paths.measurements, [&] { return make_scene(file, &measurements); });
    }
    const bool compares = !arguments.models.empty();
    const std::vector<Study> studies = compute_from(paths.measurements, [&] {
        return compares ? compare_models(list_models(files), measurements, options)
                        : std::vector{posewise::study(file, measurements, options)};
    });
    for (const Study& study : studies) {
        if (study.ending != Ending::NotIdentifiable) continue;
        throw input_error_at({paths.measurements},
                             (compares ? study.model + ": " : "") + study.undetermined);
    }
    return studies;
}

std::vector<Study> study_simulated(const StudyArguments& arguments, const CommonOptions& common,
                                   const StopSignal& stop, StudyExtras& extras) {
    io::CampaignFile file = read_with_prior(arguments.paths.campaign, arguments.prior, stop);
    expect_earlier(file, arguments.earlier);
    warn_of_unchecked_bodies(file);
    check_study_outputs(arguments, {&file}, {arguments.truth, arguments.earlier.from}, common);
    SimulatedStudyOptions options = arguments.options;
    options.random_subsets = arguments.random_subsets.value_or(options.random_subsets);
    constexpr Index most_trials = 100000;  // where a precision says when it ends
    options.trials =
        arguments.trials.value_or(options.precision > 0 ? most_trials : options.trials);
    complete_options(options, arguments, stop);
    extras.notes = describe_earlier(arguments.earlier) + describe_exact(arguments.earlier.use()) +
                   describe_unused_planning(file);
    extras.page.scene = make_scene(file);
    ProgressLine line("simulating", arguments.progress);
    const RateNote note;
    options.progress = [&](const Progress& progress) { line(progress, note(progress)); };
    const auto campaigns = list_variations(arguments, file, stop);
    return compute_from(arguments.paths.campaign,
                        [&] { return simulate_study(campaigns, options); });
}

std::vector<Study> read_store(const std::string& path) {
    const std::vector<TrialSeries> series = io::series_in_store(path);
    const TrialStore store = io::read_trial_store(path);
    std::vector<Study> studies;
    for (const TrialSeries& one : series) {
        studies.push_back(compute_from(path, [&] { return study_of_trials(one, store); }));
    }
    return studies;
}

std::vector<std::vector<Study>> read_store_groups(const std::string& path) {
    std::vector<std::vector<Study>> groups;
    for (const Study& study : read_store(path)) {
        if (study.rows.empty()) continue;
        const auto group =
            std::find_if(groups.begin(), groups.end(), [&](const std::vector<Study>& others) {
                return belong_together(others.front(), study);
            });
        (group == groups.end() ? groups.emplace_back() : *group).push_back(study);
    }
    for (std::vector<Study>& group : groups) keep_common(group);
    std::erase_if(groups, [](const auto& group) { return group.front().rows.empty(); });
    if (groups.empty()) throw input_error_at({path}, "holds no split that is finished yet");
    return groups;
}

std::string describe_studies(const std::vector<Study>& studies) {
    const bool compares = studies.size() > 1 || !studies.front().model.empty();
    return compares ? format(studies) : format(studies.front());
}

}  // namespace posewise::cli
