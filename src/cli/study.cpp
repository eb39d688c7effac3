#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>

#include "../core/text.hpp"
#include "../io/atomic_file.hpp"
#include "../report/plot.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "files.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/report/reports.hpp"

namespace posewise::cli {
namespace {

namespace fs = std::filesystem;

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
0.57, geometric mean over the splits with its 95 % interval. Subsets that do not identify the model
count as the worst ("-": no number). The pose count from which a column stays flat is enough.

With few configurations there are no splits (--splits 0): each subset is judged on what it leaves,
and one that takes the telling configurations is judged on easier ones than others are.)";

struct StudyArguments {
    std::optional<bool> prior;
    InputPaths paths;
    std::vector<Criterion> criteria;
    std::optional<std::uint64_t> seed;
    std::string csv;
    std::string plot;
    bool progress = false;
    StudyOptions options;
};

Index parse_count(std::string_view text) {
    Index count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc() || end != text.data() + text.size() || count < 1 || count > 1000000) {
        throw CLI::ValidationError(
            "--poses", detail::quote(text) + " is not a pose count; must be like 5:24 or 6,9,12");
    }
    return count;
}

/// "5:24" and "6,9,12", and both mixed.
std::vector<Index> parse_counts(const std::string& text) {
    std::vector<Index> counts;
    for (const std::string& part : CLI::detail::split(text, ',')) {
        const auto colon = part.find(':');
        const Index first = parse_count(part.substr(0, colon));
        const Index last = colon == std::string::npos ? first : parse_count(part.substr(colon + 1));
        if (first > last) {
            throw CLI::ValidationError(
                "--poses", "is " + detail::quote(part) + "; the first must not be above the last");
        }
        for (Index count = first; count <= last; ++count) counts.push_back(count);
    }
    if (counts.empty()) throw CLI::ValidationError("--poses", "'" + text + "' holds no pose count");
    return counts;
}

std::vector<Criterion> parse_criteria(const std::string& text) {
    std::vector<Criterion> criteria;
    try {
        for (const std::string& name : CLI::detail::split(text, ',')) {
            criteria.push_back(parse_criterion(name));
        }
    } catch (const InputError& error) {
        throw CLI::ValidationError("--criteria", error.what());
    }
    if (criteria.empty()) throw CLI::ValidationError("--criteria", "is empty; must be like d,a");
    return criteria;
}

/// A folder of its own among the temporary ones, gone with all it holds at the end.
class ScratchFolder {
  public:
    ScratchFolder() {
        std::error_code error;
        std::string pattern = (fs::temp_directory_path(error) / "posewise.XXXXXX").string();
        if (error || ::mkdtemp(pattern.data()) == nullptr) {
            throw InputError("no temporary folder can be made; TMPDIR must name one");
        }
        path_ = pattern;
    }
    ~ScratchFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    std::string path_of(const std::string& name) const { return (path_ / name).string(); }

  private:
    fs::path path_;
};

/// Leaves the script for the user, unless a file has its name already. What to do with it.
std::string leave_script(const std::string& script, const std::string& image_path) {
    const std::string path = image_path + ".gnuplot";
    if (fs::exists(fs::symlink_status(path))) return "";
    detail::write_file(path, script);
    return "; its script is left, try: gnuplot " + path;
}

/// Draws elsewhere, so that the image is replaced by a whole one or not at all.
void draw_plot(const std::string& image_path, const Study& study) {
    const ScratchFolder folder;
    const std::string image = folder.path_of("image" + fs::path(image_path).extension().string());
    const std::string script = folder.path_of("script.gnuplot");
    detail::write_file(script, detail::study_plot_script(study, image));
    try {
        detail::run_gnuplot(script);
    } catch (const InputError& error) {
        throw input_error_at(
            {image_path},
            std::string("the plot was not drawn, ") + error.what() +
                leave_script(detail::study_plot_script(study, image_path), image_path));
    }
    detail::write_file(image_path, detail::read_file(image));
}

void study(const StudyArguments& arguments) {
    const InputPaths& paths = arguments.paths;
    if (!arguments.plot.empty()) detail::check_image_path(arguments.plot);
    check_outputs({paths.campaign, paths.measurements}, {arguments.csv, arguments.plot});
    const io::CampaignFile file = read_with_prior(paths.campaign, arguments.prior);
    const auto measurements = read_measured(paths.measurements, file);
    StudyOptions options = arguments.options;
    options.seed = arguments.seed.value_or(file.seed);
    options.criteria = arguments.criteria;
    if (options.criteria.empty()) options.criteria = {file.criterion};

    ProgressLine line("calibrating", arguments.progress);
    options.progress = [&](const Progress& progress) { line(progress); };
    const Study result = compute_from(paths.measurements,
                                      [&] { return posewise::study(file, measurements, options); });
    if (result.ending == Ending::NotIdentifiable) {
        throw input_error_at({paths.measurements}, result.undetermined);
    }
    print(format(result));
    if (!arguments.csv.empty()) detail::write_file(arguments.csv, study_csv(result));
    if (!arguments.plot.empty()) draw_plot(arguments.plot, result);
}

void add_study_options(CLI::App& command, StudyArguments& arguments) {
    command.add_option_function<std::string>(
        "-c,--criteria",
        [&arguments](const std::string& text) { arguments.criteria = parse_criteria(text); },
        "Criteria to choose by, such as v,d,o1 (default: the campaign's, else v)");
    command
        .add_option("--random", arguments.options.random_subsets, "Random subsets per pose count")
        ->check(whole_number(0, 1000000))
        ->capture_default_str();
    command
        .add_option(
            "--splits", arguments.options.splits,
            "Splits into configurations to choose from and to judge all subsets on; 0: "
            "each is judged on what it leaves, planned ones then on easier poses (default: "
            "10, or 0 where no pose count is up to a third of what there is to choose from)")
        ->check(whole_number(0, 1000));
    command
        .add_option("--holdout", arguments.options.holdout,
                    "Part of the configurations that a split judges on")
        ->check(real_number(0.01, 0.99))
        ->capture_default_str();
    command.add_option_function<std::string>(
        "-k,--poses",
        [&arguments](const std::string& text) {
            arguments.options.pose_counts = parse_counts(text);
        },
        "Pose counts, 5:24 or 6,9,12 (default: 8,12,16,20,30,50 up to a third of what there is to "
        "choose from; without splits from the least that identifies to all but one)");
    add_prior_option(command, arguments.prior, ": of choice and calibration alike");
    command.add_option("--starts", arguments.options.starts, "Starts of each exchange")
        ->check(whole_number(1, 1000000))
        ->capture_default_str();
    command.add_option("--seed", arguments.seed, "Of all random choices (default: the campaign's)")
        ->check(whole_number(0, largest_seed));
    command.add_option("--csv", arguments.csv, "Write every subset's result to this file")
        ->check(file_name());
    command.add_option("--plot", arguments.plot, "Draw error against pose count: .svg or .png")
        ->check(file_name());
    command.add_flag("--progress", arguments.progress,
                     "Show progress on standard error even if it is no terminal");
}

}  // namespace

void add_study(CLI::App& program) {
    const auto arguments = std::make_shared<StudyArguments>();
    CLI::App* command =
        program.add_subcommand("study", "Accuracy against number of poses, optimal and random");
    add_campaign_argument(*command, arguments->paths);
    add_measurements_option(*command, arguments->paths);
    add_study_options(*command, *arguments);
    command->footer(study_footer);
    command->callback([arguments] { study(*arguments); });
}

}  // namespace posewise::cli
