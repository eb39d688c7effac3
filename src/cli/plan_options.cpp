#include "plan_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common.hpp"
#include "options.hpp"
#include "planner/focus_names.hpp"

namespace posewise::cli {

void add_criterion_option(CLI::App& command, RequestArguments& arguments, const std::string& help) {
    command.add_option("-c,--criterion", arguments.criterion, help)->check(criterion_check());
}

void add_focus_option(CLI::App& command, RequestArguments& arguments) {
    command
        .add_option("--focus", arguments.focus,
                    "Parameters that count: all, the robot's, or place, where targets, tool, "
                    "camera or board are on the flange (hand-eye); others are estimated along")
        ->check(CLI::IsMember(detail::words_of(detail::focus_names)))
        ->capture_default_str();
}

void add_workspace_options(CLI::App& command, PlanRequest& request) {
    CLI::Option* const given =
        command
            .add_option("--workspace", request.sources.workspace,
                        "Where the robot shall be accurate: configurations (CSV) (default: drawn)")
            ->check(file_name());
    command
        .add_option("--workspace-poses", request.workspace_count,
                    "How many are drawn for it otherwise")
        ->check(whole_number(1, 20000))
        ->default_val(Index{500})
        ->excludes(given);
    command
        .add_option("--workspace-box-mm", request.workspace_box_mm,
                    "Box of the base frame that targets are in then: least x,y,z,largest x,y,z "
                    "(default: the cell's target boxes)")
        ->delimiter(',')
        ->expected(6)
        ->excludes(given);
    command
        .add_option("--workspace-target", request.workspace_target,
                    "Target whose position counts, from 1 (0: all of them)")
        ->check(whole_number(0, 10000))
        ->capture_default_str();
}

void add_search_options(CLI::App& command, RequestArguments& arguments,
                        const std::string& seed_help, const std::string& default_out) {
    command.add_option("--seed", arguments.seed, seed_help)->check(whole_number(0, largest_seed));
    command
        .add_option("--time", arguments.request.time_limit,
                    "Seconds after which to stop, reading included")
        ->check(real_number(1e-3, 1e9));
    command
        .add_option("-o,--out", arguments.out,
                    "Plan file (default: " + default_out + " in this folder)")
        ->check(file_name());
}

io::CampaignFile read_planned(const RequestArguments& arguments, const StopSignal& stop) {
    const EarlierArguments& earlier = arguments.earlier;
    PlanSources sources = arguments.request.sources;
    sources.estimate = earlier.from;
    io::CampaignFile campaign =
        read_planned(sources, earlier.use(), arguments.prior, earlier.is_forced, stop);
    warn_of_limits(campaign);
    return campaign;
}

void note_overtime(double limit, const StopSignal& stop, std::chrono::steady_clock::time_point read,
                   const char* what) {
    constexpr double most = 0.5;  // s
    using Seconds = std::chrono::duration<double>;
    const auto now = std::chrono::steady_clock::now();
    const double late = Seconds(now - stop.deadline).count();
    if (limit == 0 || late < std::max(most, 0.1 * limit)) return;
    const double planned = Seconds(now - read).count();
    const double all = limit + late;
    print_warning(fmt::format(
        "took {:.1f} s, --time is {:g}: {:.1f} s to read the campaign and what goes with it, "
        "{:.1f} s to {}; its single steps are not cut short",
        all, limit, all - planned, planned, what));
}

PlanRequest make_request(const RequestArguments& arguments) {
    PlanRequest request = arguments.request;
    if (!arguments.criterion.empty()) request.criterion = parse_criterion(arguments.criterion);
    request.has_prior = arguments.prior.value_or(false);
    request.seed = arguments.seed;
    request.focus = *detail::find_named(detail::focus_names, arguments.focus);
    request.sources.estimate = arguments.earlier.from;
    request.earlier = arguments.earlier.use();
    return request;
}

}  // namespace posewise::cli
