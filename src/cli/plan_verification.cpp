#include "plan_verification.hpp"

#include <fmt/format.h>

#include "common.hpp"
#include "interrupt.hpp"
#include "options.hpp"

namespace posewise::cli {

void add_verification_options(CLI::App& command, VerificationArguments& arguments) {
    CLI::Option* const verify = command.add_flag(
        "--verify", arguments.is_wanted,
        "Check the prediction on robots that are drawn, measured at the poses and calibrated");
    command
        .add_option("--verify-digits", arguments.digits,
                    "Significant digits of the robots' standard deviation that are to be sure")
        ->check(whole_number(1, 4))
        ->capture_default_str()
        ->needs(verify);
    command.add_option("--verify-robots", arguments.most_robots, "At most")
        ->check(whole_number(100, 100000000))
        ->capture_default_str()
        ->needs(verify);
}

void check_verification(const VerificationArguments& arguments, const Campaign& campaign,
                        const PlanningOptions& options) {
    if (arguments.is_wanted) check_simulable(campaign, options);
}

std::optional<SimulatedPlan> verify_made(const VerificationArguments& arguments,
                                         const TargetPlanning& made, const PlanningOptions& options,
                                         bool shows_progress) {
    if (!arguments.is_wanted) return std::nullopt;
    SimulatedPlanOptions simulated;
    simulated.digits = arguments.digits;
    simulated.most_robots = arguments.most_robots;
    simulated.workspace = options.workspace;
    simulated.seed = made.planning->plan.request.seed.value();
    simulated.stop = options.stop;
    if (made.ending != TargetEnding::NotRun) {
        simulated.quantity = made.target.quantity;
        simulated.assurance = made.target.assurance;
        simulated.missing = made.target.robust_to;
    }
    std::optional<InterruptFlag> interrupted;
    if (!options.stop.is_interrupted()) {
        interrupted.emplace("interrupted twice; the plan is written");
        simulated.stop.interrupted = interrupted->get();
    }
    ProgressLine line("verifying", shows_progress);
    simulated.progress = [&](const Progress& state) {
        line(state, fmt::format("{} of about {} robots", state.done, state.total));
    };
    return simulate_plan(*made.planning, simulated);
}

}  // namespace posewise::cli
