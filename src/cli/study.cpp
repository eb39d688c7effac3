#include <cstdio>
#include <memory>

#include "../io/atomic_file.hpp"
#include "../report/plot.hpp"
#include "commands.hpp"
#include "files.hpp"
#include "measured.hpp"
#include "posewise/core/units.hpp"
#include "posewise/io/json_reports.hpp"
#include "posewise/report/reports.hpp"
#include "study_options.hpp"
#include "study_plot.hpp"

namespace posewise::cli {
namespace {

constexpr const char* study_footer = R"(
Example:
  posewise study campaign.yaml -m measurements.csv --criteria v,d --random 100 --plot study.svg

For each pose count: chooses that many of the measured configurations by each criterion and at
random, calibrates with them from nothing, and judges on configurations held out, the same ones for
all, over ten random splits. Prints the distance RMS there, in mm:
  poses    v/mm  expected  v/random  95 %        random 10 %/mm  50 %/mm  90 %/mm  subsets  unidentified
      8  0.2773    0.2065      0.57  0.43..0.78          0.2431   0.4535   1.2347      100             0
is read: eight configurations chosen by V leave 0.28 mm, median of the splits, where the calibrations
themselves expect 0.21; half of all random eights leave more than 0.45. Planned against random it is
0.57, geometric mean over the splits with its 95 % interval: better where all of it is below 1, loses
where all is above 1, within chance else. Subsets that do not identify the model count as the worst
("-": no number). The pose count from which a column stays flat is enough.

--from studies the robot as an earlier calibration found it; with --as-prior each subset is calibrated
with what that knew, with --only base,targets only these are found.

With few configurations there are no splits (--splits 0): each subset is judged on what it leaves,
and one that takes the telling configurations is judged on easier ones than others are.

  posewise study campaign.yaml -m measurements.csv --models geometric,full
repeats the study with each of these in the place of the campaign's robot.errors, all else the same:
the splits, the pose counts and the random subsets. A line for each pose count and model says what
random and planned subsets leave, planned against random of that model, and of the first one.)";

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
        io::set_prior(file, arguments.prior.value_or(file.spread.is_prior));
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

void study(const StudyArguments& arguments, const CommonOptions& common) {
    const InputPaths& paths = arguments.paths;
    if (!arguments.plot.empty()) detail::check_image_path(arguments.plot);
    const std::vector<io::CampaignFile> files = read_files(arguments);
    const io::CampaignFile& file = files.front();
    check_outputs({&file}, {paths.measurements, arguments.earlier.from},
                  {arguments.csv, arguments.plot}, common);
    const auto measurements =
        read_measured_without(arguments.excluded, paths.measurements, file, arguments.earlier);
    StudyOptions options = arguments.options;
    options.seed = arguments.seed.value_or(file.seed);
    options.criteria = arguments.criteria;
    if (options.criteria.empty()) options.criteria = {file.criterion};
    options.least_distance = to_radians(arguments.least_distance_deg);

    ProgressLine line("calibrating", arguments.progress);
    options.progress = [&](const Progress& progress) { line(progress); };
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
    print(common.json ? io::to_json(studies)
                      : (compares ? format(studies) : format(studies.front())) +
                            describe_earlier(arguments.earlier) + describe_unused_planning(file));
    if (!arguments.csv.empty()) {
        detail::write_file(arguments.csv,
                           compares ? study_csv(studies) : study_csv(studies.front()));
    }
    std::fflush(stdout);  // gnuplot may take its time
    if (!arguments.plot.empty()) draw_plot(arguments.plot, studies);
}

}  // namespace

void add_study(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<StudyArguments>();
    CLI::App* command =
        program.add_subcommand("study", "Accuracy against number of poses, optimal and random");
    add_campaign_argument(*command, arguments->paths);
    add_measurements_option(*command, arguments->paths);
    add_study_options(*command, *arguments);
    command->footer(study_footer);
    command->callback([arguments, &common] { study(*arguments, common); });
}

}  // namespace posewise::cli
