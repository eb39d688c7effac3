#include <memory>
#include <optional>

#include "blocks_options.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "estimates.hpp"
#include "files.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/report/reports.hpp"

namespace posewise::cli {
namespace {

constexpr const char* indices_footer = R"(
Example:
  posewise indices campaign.yaml -m measurements.csv

Prints how much the measured configurations tell about the parameters, before any calibration: the
observability indices O1 to O5, the criteria A, D, E, G, V (larger is better; G and V predict the
file's own configurations) and the condition number (smaller is better). Two columns: whitened by
the noise and scaled by the expected errors, which is what posewise selects by, and plain in mm and
mrad as papers print them. The weakest directions name what these poses can hardly tell apart:
  1.2 % of the expected size: 0.71 mm Tx1, -0.70 mm base.x
is read: these errors at once, in this proportion, are known only to 1.2 % of that size. With --from the
robot is as an earlier calibration found it, with --as-prior what that knew counts, too.

--blocks rates plain blocks without a robot, as select --blocks takes them, all or those of --subset;
G and V predict all of them:
  posewise indices --blocks jacobians.npy --subset mine.txt
--write-blocks writes the whitened, scaled blocks that were rated, as one array.)";

struct IndicesArguments {
    InputPaths paths;
    std::vector<std::string> excluded;
    std::optional<bool> prior;
    EarlierArguments earlier;
    Index directions = 3;
    int digits = 6;
    std::string blocks;
    PlanSources sources;  ///< layout of the blocks
    std::string subset;
    std::string written_blocks;
};

Measurements read_input(const IndicesArguments& arguments, const io::CampaignFile& file) {
    const auto& excluded = arguments.excluded;
    const MeasuredPlans plans = read_measured_plans(arguments.paths, file);
    const auto all =
        read_measured_without(excluded, arguments.paths, file, arguments.earlier, plans);
    check_needs_unit(arguments.paths, all.is_joined);
    if (!plans.all) return all;
    return take(all, find_planned(arguments.paths.plan, *plans.all, file, all, excluded));
}

/// The parameters' names in the file, else their columns.
std::vector<std::string> names_of(const io::BlocksFile& file) {
    if (!file.names.empty()) return file.names;
    std::vector<std::string> names;
    for (Index k = 1; k <= file.blocks.parameter_count(); ++k) {
        names.push_back("column " + std::to_string(k));
    }
    return names;
}

void print_indices_of_blocks(const CLI::App& command, const IndicesArguments& arguments,
                             const CommonOptions& common) {
    check_only(command,
               {"--blocks", "--rows", "--variable", "--subset", "--prior", "--directions",
                "--digits", "--write-blocks", "--json", "--help"},
               "is not of plain blocks (--blocks); must be left out");
    const std::string& path = arguments.blocks;
    check_blocks_usage(path, arguments.sources);
    check_outputs({}, {path, arguments.subset}, {arguments.written_blocks}, common);
    const io::BlocksFile file = read_blocks(path, arguments.sources);
    std::vector<Index> subset;
    if (!arguments.subset.empty()) {
        subset = io::read_subset(arguments.subset, file.blocks.count());
    }
    const bool has_prior = arguments.prior.value_or(false);
    const Rating rating = compute_from(
        path, [&] { return rate(file.blocks, subset, has_prior, arguments.directions); });
    if (!arguments.written_blocks.empty()) {
        io::write_blocks(arguments.written_blocks,
                         subset.empty() ? file.blocks : take(file.blocks, subset), file.names);
    }
    if (common.json) return print_document(io::to_json(rating, names_of(file), has_prior));
    print_size(file.blocks, common);
    print(format(rating, names_of(file), has_prior, arguments.digits));
}

void print_indices(const IndicesArguments& arguments, const CommonOptions& common) {
    auto file = read_with_prior(arguments.paths.campaign, arguments.prior);
    expect_earlier(file, arguments.earlier);
    const InputPaths& paths = arguments.paths;
    check_outputs({&file}, {paths.measurements, paths.plan, arguments.earlier.from},
                  {arguments.written_blocks}, common);
    const Measurements measurements = read_input(arguments, file);
    const Rating rating = compute_from(arguments.paths.measurements, [&] {
        return rate(file, measurements, arguments.directions);
    });
    if (!arguments.written_blocks.empty()) {
        const Parameters registered = determined(register_base_and_targets(file, measurements));
        io::write_blocks(arguments.written_blocks,
                         make_blocks(file, registered, measurements.configurations,
                                     rating.repeats * share_seen(measurements)),
                         parameter_names(file));
    }
    if (common.json) return print_document(io::to_json(rating, file));
    print(format(rating, file, arguments.digits) + describe_earlier(arguments.earlier) +
          describe_unused_planning(file));
}

}  // namespace

void add_indices(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<IndicesArguments>();
    CLI::App* command =
        program.add_subcommand("indices", "Rate measured configurations by every index");
    add_campaign_argument(*command, arguments->paths)->required(false);
    add_measurements_option(*command, arguments->paths)->required(false);
    add_points_options(*command, arguments->paths.plan, arguments->paths.points_unit,
                       "Only the configurations of this plan");
    add_exclude_option(*command, arguments->excluded);
    add_prior_option(*command, arguments->prior, ": told beside what is measured");
    command->add_option("--directions", arguments->directions, "How many weak directions to name")
        ->check(whole_number(0, 1000))
        ->capture_default_str();
    add_earlier_options(*command, arguments->earlier);
    add_digits_option(*command, arguments->digits);
    CLI::Option* const blocks = add_blocks_option(*command, arguments->blocks);
    add_blocks_layout(*command, arguments->sources);
    command
        ->add_option(
            "--subset", arguments->subset,
            "With --blocks: only these candidates, by number from 0 (text, .npy), or those of "
            "a plan of select")
        ->check(file_name())
        ->needs(blocks);
    command
        ->add_option("--write-blocks", arguments->written_blocks,
                     "Write the rated blocks to this file, .npy, .npz or .csv")
        ->check(file_name());
    command->footer(indices_footer);
    command->callback([command, arguments, &common] {
        if (!arguments->blocks.empty()) {
            return print_indices_of_blocks(*command, *arguments, common);
        }
        check_blocks_usage("", arguments->sources);
        if (arguments->paths.campaign.empty()) throw CLI::RequiredError("CAMPAIGN");
        if (arguments->paths.measurements.empty()) throw CLI::RequiredError("--measurements");
        print_indices(*arguments, common);
    });
}

}  // namespace posewise::cli
