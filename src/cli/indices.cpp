#include <memory>
#include <optional>

#include "commands.hpp"
#include "common.hpp"
#include "estimates.hpp"
#include "files.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "posewise/io/documents.hpp"
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
robot is as an earlier calibration found it, with --as-prior what that knew counts, too.)";

struct IndicesArguments {
    InputPaths paths;
    std::vector<std::string> excluded;
    std::optional<bool> prior;
    EarlierArguments earlier;
    Index directions = 3;
    int digits = 6;
};

Measurements read_input(const IndicesArguments& arguments, const io::CampaignFile& file) {
    const auto& excluded = arguments.excluded;
    const std::optional<Plan> plan = read_measured_plan(arguments.paths, file);
    const auto all =
        read_measured_without(excluded, arguments.paths, file, arguments.earlier, plan);
    if (!plan) return all;
    return take(all, find_planned(arguments.paths.plan, *plan, file, all, excluded));
}

void print_indices(const IndicesArguments& arguments, const CommonOptions& common) {
    auto file = read_with_prior(arguments.paths.campaign, arguments.prior);
    expect_earlier(file, arguments.earlier);
    const Measurements measurements = read_input(arguments, file);
    const Rating rating = compute_from(arguments.paths.measurements, [&] {
        return rate(file, measurements, arguments.directions);
    });
    if (common.json) return print_document(io::to_json(rating, file));
    print(format(rating, file, arguments.digits) + describe_earlier(arguments.earlier) +
          describe_unused_planning(file));
}

}  // namespace

void add_indices(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<IndicesArguments>();
    CLI::App* command =
        program.add_subcommand("indices", "Rate measured configurations by every index");
    add_campaign_argument(*command, arguments->paths);
    add_measurements_option(*command, arguments->paths);
    add_points_options(*command, arguments->paths, "Only the configurations of this plan");
    add_exclude_option(*command, arguments->excluded);
    add_prior_option(*command, arguments->prior, ": told beside what is measured");
    command->add_option("--directions", arguments->directions, "How many weak directions to name")
        ->check(whole_number(0, 1000))
        ->capture_default_str();
    add_earlier_options(*command, arguments->earlier);
    add_digits_option(*command, arguments->digits);
    command->footer(indices_footer);
    command->callback([arguments, &common] { print_indices(*arguments, common); });
}

}  // namespace posewise::cli
