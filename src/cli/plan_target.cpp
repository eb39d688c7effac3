#include "plan_target.hpp"

#include <map>

#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/report/reports.hpp"

namespace posewise::cli {
namespace {

const std::map<std::string, ErrorQuantity> quantities{
    {"rms", ErrorQuantity::Rms}, {"p95", ErrorQuantity::Percentile95}, {"max", ErrorQuantity::Max}};

}  // namespace

void add_target_options(CLI::App& command, TargetArguments& arguments,
                        const std::vector<CLI::Option*>& excluded) {
    CLI::Option* const limit =
        command
            .add_option("--target-mm", arguments.limit_mm,
                        "As few poses as keep the position error below this, model error and "
                        "repeatability included")
            ->check(real_number(1e-6, 1e6));
    command
        .add_option("--quantity", arguments.quantity,
                    "What to keep below it: rms, p95 or max over the workspace's positions")
        ->check(CLI::IsMember(quantities))
        ->capture_default_str()
        ->needs(limit);
    command
        .add_option("--assurance", arguments.assurance, "Probability with which the target is kept")
        ->check(real_number(0.01, 0.999))
        ->capture_default_str()
        ->needs(limit);
    CLI::Option* const minutes =
        command
            .add_option("--minutes", arguments.minutes,
                        "As many poses as fit: moves, and the cell's dwell_s for each sample")
            ->check(real_number(1e-6, 1e6));
    CLI::Option* const most =
        command
            .add_option("--poses-at-most", arguments.most_poses, "With --target-mm or --minutes")
            ->check(whole_number(1, 10000))
            ->capture_default_str();
    command
        .add_option("--robust-to", arguments.robust_to,
                    "So many poses, those that hurt most, may be missing")
        ->check(whole_number(0, 1000))
        ->capture_default_str();
    for (CLI::Option* const option : excluded) {
        limit->excludes(option);
        minutes->excludes(option);
        most->excludes(option);
    }
}

TargetPlanning plan_for_target(const Campaign& campaign, const PlanningOptions& options,
                               const TargetArguments& arguments) {
    constexpr double seconds_per_minute = 60;
    TargetOptions target;
    if (arguments.limit_mm > 0) target.limit = arguments.limit_mm / mm_per_m;
    if (arguments.minutes > 0) target.duration = seconds_per_minute * arguments.minutes;
    target.assurance = arguments.assurance;
    target.quantity = quantities.at(arguments.quantity);
    target.most_poses = arguments.most_poses;
    target.robust_to = arguments.robust_to;
    TargetPlanning found = posewise::plan_for_target(campaign, options, target);
    if (!found.planning) throw InputError("--target-mm: " + describe_shortfall(found));
    return found;
}

}  // namespace posewise::cli
