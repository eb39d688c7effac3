#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "estimates.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/task/plan.hpp"

/// What the command lines of select and plan have in common.
namespace posewise::cli {

struct RequestArguments {
    PlanRequest request;
    std::string criterion;
    std::optional<bool> prior;
    std::optional<std::uint64_t> seed;
    std::string focus = "all";
    EarlierArguments earlier;
    std::string out;
    bool progress = false;
};

/// -c, --criterion with that help.
void add_criterion_option(CLI::App& command, RequestArguments& arguments, const std::string& help);
void add_focus_option(CLI::App& command, RequestArguments& arguments);
/// Of plan: where accuracy matters.
void add_workspace_options(CLI::App& command, PlanRequest& request);
/// --seed with that help, --time, and -o, --out, by default named as `default_out` says.
void add_search_options(CLI::App& command, RequestArguments& arguments,
                        const std::string& seed_help, const std::string& default_out);

/// The campaign that poses are planned with, as its file and the command line say.
io::CampaignFile read_planned(const RequestArguments& arguments, const StopSignal& stop);

/// Says on standard error what a time limit that was not kept went to: up to `read`, the inputs,
/// then `what` was done.
void note_overtime(double limit, const StopSignal& stop, std::chrono::steady_clock::time_point read,
                   const char* what);

PlanRequest make_request(const RequestArguments& arguments);

}  // namespace posewise::cli
