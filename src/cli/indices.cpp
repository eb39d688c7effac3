#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "../core/format.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "files.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/jacobian/identifiability.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/choice.hpp"

namespace posewise::cli {
namespace {

constexpr const char* footer = R"(
Example:
  posewise indices campaign.yaml -m measurements.csv

Prints how much the measured configurations tell about the parameters, before any calibration: the
observability indices O1 to O5, the criteria A, D, E, G, V (larger is better; G and V predict the
file's own configurations) and the condition number (smaller is better). Two columns: whitened by
the noise and scaled by the expected errors, which is what posewise selects by, and plain in mm and
mrad as papers print them. The weakest directions name what these poses can hardly tell apart:
  1.2 % of the expected size: 0.71 mm Tx1, -0.70 mm base.x
is read: these errors at once, in this proportion, are known only to 1.2 % of that size.)";

struct Arguments {
    InputPaths paths;
    std::string plan;
    Index directions = 3;
};

/// Blocks, and below them what a prior tells: the identity's rows of parameters that have one.
struct Rows {
    const Blocks& blocks;
    MatrixXd stacked;
    VectorXd s;  ///< its singular values, largest first

    Rows(const Blocks& of_poses, const MatrixXd& prior) : blocks(of_poses) {
        std::vector<Index> known;
        for (Index k = 0; k < prior.rows(); ++k) {
            if (prior(k, k) > 0) known.push_back(k);
        }
        stacked.resize(blocks.matrix.rows() + static_cast<Index>(known.size()),
                       blocks.parameter_count());
        stacked << blocks.matrix, prior(known, Eigen::all);
        s = singular_values(stacked);
    }
    double evaluate(Criterion criterion) const {
        if (needs_test_poses(criterion)) {
            return posewise::evaluate(criterion, stacked.transpose() * stacked, blocks.count(),
                                      &blocks);
        }
        return posewise::evaluate(criterion, s, blocks.count());
    }
};

double condition_number(const VectorXd& s) {
    const double least = s[s.size() - 1];
    return least > 0 ? s[0] / least : std::numeric_limits<double>::infinity();
}

detail::Table index_table(const Rows& scaled, const Rows& plain) {
    detail::Table table{{"index", "whitened, scaled", "plain, mm and mrad"}, {}};
    for (const Criterion criterion : all_criteria) {
        table.rows.push_back({std::string(criterion_name(criterion)),
                              detail::format_short(scaled.evaluate(criterion), 6),
                              detail::format_short(plain.evaluate(criterion), 6)});
    }
    table.rows.push_back({"condition", detail::format_short(condition_number(scaled.s), 6),
                          detail::format_short(condition_number(plain.s), 6)});
    return table;
}

/// The direction in words: errors in mm and mrad, and how well their sum is known.
std::string describe_direction(const Campaign& campaign, const WeakDirection& direction) {
    const auto names = parameter_names(campaign);
    const auto is_angle = parameter_is_angle(campaign);
    const VectorXd scale = parameter_scale(campaign);
    std::string terms;
    for (const ParameterTerm& term : direction.terms) {
        const auto k = static_cast<std::size_t>(term.parameter);
        terms += terms.empty() ? "" : ", ";
        terms += detail::format_error(term.coefficient * scale[term.parameter], is_angle[k]) + ' ' +
                 names[k];
    }
    if (!(direction.singular_value > 0)) return "not seen at all: " + terms;
    return fmt::format("{} % of the expected size: {}",
                       detail::format_short(100 / direction.singular_value, 3), terms);
}

Measurements read_input(const Arguments& arguments, const io::CampaignFile& file) {
    const auto all = read_measured(arguments.paths.measurements, file);
    return arguments.plan.empty() ? all : take(all, find_planned(all, arguments.plan));
}

void print_indices(const Arguments& arguments) {
    const auto file = io::read_campaign(arguments.paths.campaign);
    const Campaign& campaign = file;
    const Measurements measurements = read_input(arguments, file);
    const Parameters registered = compute_from(arguments.paths.measurements, [&] {
        return determined(register_base_and_targets(campaign, measurements));
    });
    const double repeats = mean_repeats(measurements);
    const RowMatrixXd share = share_seen(measurements);
    const Blocks scaled =
        make_blocks(campaign, registered, measurements.configurations, repeats * share);
    // m per m and m per rad are mm per mm and mm per mrad: nothing to convert.
    const Blocks plain =
        make_plain_blocks(campaign, registered, measurements.configurations, share);
    print(fmt::format("{} configurations, {} parameters\n{}", scaled.count(),
                      scaled.parameter_count(), detail::describe_scaling(campaign, repeats)));
    const bool has_prior = campaign.spread.is_prior;
    if (has_prior) print("prior:      the scale, as standard deviation; in the first column\n");
    const MatrixXd prior = prior_information(campaign);
    const Rows whitened(scaled, prior);
    print_section("Indices (-inf, condition inf: the parameters are not identifiable)",
                  index_table(whitened, Rows(plain, MatrixXd::Zero(prior.rows(), prior.cols()))));
    print("\nWeakest directions, known to\n\n");
    for (const auto& direction : weakest_directions(whitened.stacked, arguments.directions)) {
        print("  " + describe_direction(campaign, direction) + '\n');
    }
}

}  // namespace

void add_indices(CLI::App& program) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* command =
        program.add_subcommand("indices", "Rate measured configurations by every index");
    add_campaign_argument(*command, arguments->paths);
    add_measurements_option(*command, arguments->paths);
    command->add_option("--plan", arguments->plan, "Only the configurations of this plan file")
        ->check(file_name());
    command->add_option("--directions", arguments->directions, "How many weak directions to name")
        ->check(whole_number(0, 1000))
        ->capture_default_str();
    command->footer(footer);
    command->callback([arguments] { print_indices(*arguments); });
}

}  // namespace posewise::cli
