#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "posewise/task/simulated_plan.hpp"
#include "posewise/task/target.hpp"

/// --verify of plan: its prediction on robots that are drawn.
namespace posewise::cli {

struct VerificationArguments {
    bool is_wanted = false;
    Index digits = 2;
    Index most_robots = 100000;
};

void add_verification_options(CLI::App& command, VerificationArguments& arguments);

/// Nothing: it is not wanted. Throws InputError if this cannot be verified.
void check_verification(const VerificationArguments& arguments, const Campaign& campaign,
                        const PlanningOptions& options);
/// Of a plan that `options` made and that is written already; with the progress line if it is asked
/// for. The stop signal is that of `options`, but for a new Ctrl-C.
std::optional<SimulatedPlan> verify_made(const VerificationArguments& arguments,
                                         const TargetPlanning& made, const PlanningOptions& options,
                                         bool shows_progress);

}  // namespace posewise::cli
