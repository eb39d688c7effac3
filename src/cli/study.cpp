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

constexpr const char* footer = R"(
Example:
  posewise study campaign.yaml -m measurements.csv --criteria d,a --random 100 --plot study.svg

For each pose count: chooses that many of the measured configurations by each criterion and at
random, calibrates with them from nothing, and judges on the configurations left out. Prints the
distance RMS left there, in mm:
  poses    d/mm  random 10 %/mm  50 %/mm  90 %/mm  subsets  unidentified
      6  0.2870          0.4468   2.4065        -      100            37
     13  0.1889          0.2109   0.2598   0.3606      100             6
is read: six configurations chosen by D leave 0.29 mm, half of all random sixes more than 2.4 mm.
37 of the 100 random sixes could not identify the model at all; they count as the worst, so their
90 % quantile is no number ("-"). The pose count from which a column stays flat is enough.

--splits 10 judges planned and random subsets on the same configurations, ten times anew: v/random
is the geometric mean of planned against the median random one, with its 95 % interval.)";

struct Arguments {
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

void study(const Arguments& arguments) {
    if (!arguments.plot.empty()) detail::check_image_path(arguments.plot);
    check_outputs({arguments.paths.campaign, arguments.paths.measurements},
                  {arguments.csv, arguments.plot});
    auto file = io::read_campaign(arguments.paths.campaign);
    bool& is_prior = file.spread.is_prior;
    is_prior = arguments.prior.value_or(is_prior);
    const auto measurements = read_measured(arguments.paths.measurements, file);
    StudyOptions options = arguments.options;
    options.seed = arguments.seed.value_or(file.seed);
    options.criteria = arguments.criteria;
    if (options.criteria.empty()) options.criteria = {file.criterion};

    ProgressLine line("calibrating", arguments.progress);
    options.progress = [&](const Progress& progress) { line(progress); };
    const Study result = compute_from(arguments.paths.measurements,
                                      [&] { return posewise::study(file, measurements, options); });
    if (result.ending == Ending::NotIdentifiable) {
        throw input_error_at({arguments.paths.measurements}, result.undetermined);
    }
    print(format(result));
    if (!arguments.csv.empty()) detail::write_file(arguments.csv, study_csv(result));
    if (!arguments.plot.empty()) draw_plot(arguments.plot, result);
}

void add_options(CLI::App& command, Arguments& arguments) {
    command.add_option_function<std::string>(
        "-c,--criteria",
        [&arguments](const std::string& text) { arguments.criteria = parse_criteria(text); },
        "Criteria to choose by, such as d,a,o1 (default: the campaign's)");
    command
        .add_option("--random", arguments.options.random_subsets, "Random subsets per pose count")
        ->check(whole_number(0, 1000000))
        ->capture_default_str();
    command
        .add_option("--splits", arguments.options.splits,
                    "Splits into configurations to choose from and to judge all subsets on; 0: "
                    "each is judged on what it leaves, planned ones then on easier poses")
        ->check(whole_number(0, 1000))
        ->capture_default_str();
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
        "Pose counts, 5:24 or 6,9,12 (default: from the least that identifies to all but one)");
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
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* command =
        program.add_subcommand("study", "Accuracy against number of poses, optimal and random");
    add_campaign_argument(*command, arguments->paths);
    add_measurements_option(*command, arguments->paths);
    add_options(*command, *arguments);
    command->footer(footer);
    command->callback([arguments] { study(*arguments); });
}

}  // namespace posewise::cli
