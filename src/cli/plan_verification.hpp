#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "posewise/task/planning.hpp"

/// --verify of plan: its prediction on robots that are drawn.
namespace posewise::cli {

struct VerificationArguments {
    bool is_wanted = false;
    Index digits = 2;
    Index most_robots = 100000;
};

void add_verification_options(CLI::App& command, VerificationArguments& arguments);

/// Throws InputError if it is wanted of what cannot be verified.
void check_verification(const VerificationArguments& arguments, const Campaign& campaign,
                        const PlanningOptions& options);
/// Of a plan that `options` made and that is written already; nothing if it is not wanted. Stopped
/// as `options` say, or by another Ctrl-C.
std::optional<SimulatedPlan> verify_made(const VerificationArguments& arguments,
                                         const TargetPlanning& made, const PlanningOptions& options,
                                         bool shows_progress);

}  // namespace posewise::cli
