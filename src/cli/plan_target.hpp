#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "posewise/task/planning.hpp"

/// What plan is asked for in place of a number of poses.
namespace posewise::cli {

struct TargetArguments {
    double limit_mm = 0;
    double minutes = 0;
    std::string quantity = "rms";
    double assurance = 0.95;
    Index most_poses = 1000;
    Index robust_to = 0;

    bool is_stated() const { return limit_mm > 0 || minutes > 0; }
};

/// Options that exclude `excluded`, --poses and --plan.
void add_target_options(CLI::App& command, TargetArguments& arguments,
                        const std::vector<CLI::Option*>& excluded);

/// Throws InputError, which says what would help, if there is no such plan.
TargetPlanning plan_for_target(const Campaign& campaign, const PlanningOptions& options,
                               const TargetArguments& arguments);

}  // namespace posewise::cli
