#include "plan_options.hpp"

#include "common.hpp"
#include "options.hpp"

namespace posewise::cli {

void add_criterion_option(CLI::App& command, RequestArguments& arguments, const std::string& help) {
    command.add_option("-c,--criterion", arguments.criterion, help)->check(criterion_check());
}

void add_focus_option(CLI::App& command, RequestArguments& arguments) {
    command
        .add_option("--focus", arguments.focus,
                    "all, or robot: base and targets are estimated along, but do not count")
        ->check(CLI::IsMember({"all", "robot"}))
        ->capture_default_str();
}

void add_search_options(CLI::App& command, RequestArguments& arguments,
                        const std::string& seed_help, const std::string& default_out) {
    command.add_option("--seed", arguments.seed, seed_help)->check(whole_number(0, largest_seed));
    command.add_option("--time", arguments.request.time_limit, "Seconds after which to stop")
        ->check(real_number(1e-3, 1e9));
    command
        .add_option("-o,--out", arguments.out,
                    "Plan file (default: " + default_out + " in this folder)")
        ->check(file_name());
}

void add_progress_flag(CLI::App& command, RequestArguments& arguments) {
    command.add_flag("--progress", arguments.progress,
                     "Show progress on standard error even if it is no terminal");
}

PlanRequest make_request(const RequestArguments& arguments, const io::CampaignFile* campaign,
                         Criterion usual) {
    PlanRequest request = arguments.request;
    const bool is_focused = arguments.focus == "robot";
    if (is_focused && usual == Criterion::V) usual = Criterion::D;
    request.criterion = arguments.criterion.empty() ? usual : parse_criterion(arguments.criterion);
    request.has_prior = arguments.prior.value_or(campaign != nullptr && campaign->spread.is_prior);
    request.seed = arguments.seed.value_or(campaign != nullptr ? campaign->seed : 1);
    request.is_focused_on_robot = is_focused;
    return request;
}

}  // namespace posewise::cli
