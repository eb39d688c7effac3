#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <optional>

#include "blocks_options.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "core/text.hpp"
#include "estimates.hpp"
#include "files.hpp"
#include "io/result/targets_text.hpp"
#include "options.hpp"
#include "plan_inputs.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/report/reports.hpp"

namespace posewise::cli {
namespace {

constexpr const char* verify_footer = R"(
Example:
  posewise verify measurements.plan.json
  posewise verify plan.json --targets targets.csv

Computes a plan's value, bound and efficiency again, from the files the plan names and its
certificate, whatever made the plan. Says of each whether it is as stated:
  value:      as stated, -12.345678
  bound:      stated -11.9, is -12.1
and checks the candidates (a changed file is noticed by its checksum), the poses and the limits the
plan was made under. That needs no search and no optimiser, unless a plan claims more than its
certificate proves: then branch and bound is repeated from it, until it proves as much.
Of a pose plan, as plan writes it, checks every pose (joint limits, the cell's constraints, targets
seen, degrees and mm beside the joints), the value, the predicted accuracy, each parameter's standard
deviation, and that bounds, values and efficiencies agree. The time of the visit is not checked, and
its bounds are not proven by what the file holds.
Exit code: 0 everything is as stated, 1 something is not.)";

struct VerifyArguments {
    std::string plan;
    std::string campaign;
    std::string estimate;
    std::string candidates;
    std::string augment;
    std::string groups;
    std::string test_poses;
    std::string targets;
};

void redirect(PlanSources& sources, const VerifyArguments& arguments) {
    const auto redirect_one = [](std::string& path, const std::string& other) {
        if (!other.empty()) path = other;
    };
    redirect_one(sources.campaign, arguments.campaign);
    redirect_one(sources.estimate, arguments.estimate);
    redirect_one(sources.candidates, arguments.candidates);
    redirect_one(sources.augment, arguments.augment);
    redirect_one(sources.groups, arguments.groups);
    redirect_one(sources.test_poses, arguments.test_poses);
}

/// Throws for files that a plan of this kind has none of.
void check_verify_usage(const VerifyArguments& arguments, CandidateKind kind, bool has_estimate) {
    const std::string others = arguments.groups + arguments.test_poses;
    if (!arguments.estimate.empty() && !has_estimate) {
        throw CLI::ValidationError("--from", "the plan was made without an estimate");
    }
    if (kind == CandidateKind::Pool && !(arguments.candidates + others).empty()) {
        throw CLI::ValidationError("PLAN", "is a pose plan, which takes --campaign and --augment");
    }
    if (kind == CandidateKind::Blocks && !(arguments.campaign + arguments.targets).empty()) {
        throw CLI::ValidationError(
            "PLAN", "is a choice from plain blocks, which takes no --campaign and no --targets");
    }
    if (kind == CandidateKind::Random && !arguments.candidates.empty()) {
        throw CLI::ValidationError(
            "PLAN", "is a choice from random configurations, which takes no --candidates");
    }
}

/// Throws InputError, naming what is wrong, if anything is.
void conclude(const std::string& path, const Verification& verification) {
    if (!verification.obstacle.empty()) throw input_error_at({path}, verification.obstacle);
    if (verification.is_right()) return;
    throw InputError(
        fmt::format("{}: not as stated: {}", path, fmt::join(verification.wrong(), ", ")));
}

/// An estimate that was taken by force may be taken again.
io::CampaignFile read_planned_again(const PlanRequest& request) {
    return read_planned(request.sources, request.earlier, request.has_prior, true);
}

Verification verify_choice(const Plan& plan, std::optional<io::CampaignFile> campaign,
                           const CommonOptions& common) {
    const ChoiceInputs inputs =
        read_choice_inputs(plan.request, plan.kind, plan.candidate_count, std::move(campaign));
    if (!inputs.campaign) print_size(inputs.blocks, common);
    return inputs.campaign ? verify(plan, *inputs.campaign, inputs.candidates, inputs.options)
                           : verify(plan, inputs.blocks, inputs.options);
}

Verification verify_continuous(const Plan& plan, const std::string& path,
                               const io::CampaignFile& campaign) {
    const PlanningOptions options = read_planning_inputs(plan.request, campaign);
    const std::string mismatch = describe_mismatch(plan, campaign);
    if (!mismatch.empty()) throw input_error_at({path}, mismatch);
    return verify(plan, campaign, options);
}

/// What was checked.
std::string describe_plan(const Plan& plan, Index candidate_count) {
    const std::string_view criterion = criterion_name(plan.request.criterion);
    if (plan.is_continuous()) {
        return fmt::format("{} by {}", detail::count_of(std::ssize(plan.poses), "pose"), criterion);
    }
    return fmt::format("{} of {} by {}", plan.request.pose_count,
                       detail::count_of(candidate_count, "candidate"), criterion);
}

void verify_file(const VerifyArguments& arguments, const CommonOptions& common) {
    Plan plan = io::read_plan(arguments.plan);
    check_verify_usage(arguments, plan.kind, !plan.request.sources.estimate.empty());
    redirect(plan.request.sources, arguments);
    std::optional<io::CampaignFile> campaign;
    if (plan.kind != CandidateKind::Blocks) campaign = read_planned_again(plan.request);
    const std::string& targets = arguments.targets;
    const PlanSources& sources = plan.request.sources;
    if (!targets.empty()) {
        check_outputs(
            {&*campaign},
            {arguments.plan, sources.estimate, sources.candidates, sources.augment, sources.groups,
             sources.test_poses, sources.workspace, sources.measured_plan},
            {targets}, common);
        detail::check_has_targets(targets, *campaign);
    }
    const Verification verification = plan.is_continuous()
                                          ? verify_continuous(plan, arguments.plan, *campaign)
                                          : verify_choice(plan, campaign, common);
    if (common.json) {
        print_document(io::to_json(verification, plan, arguments.plan));
    } else {
        print(fmt::format("{}: {}\n{}", detail::escape_controls(arguments.plan),
                          describe_plan(plan, verification.candidate_count),
                          format_findings(verification.findings)));
    }
    conclude(arguments.plan, verification);
    if (!targets.empty()) io::write_targets(targets, *campaign, plan);
}

}  // namespace

void add_verify(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<VerifyArguments>();
    CLI::App* command =
        program.add_subcommand("verify", "Check a plan's value, bound and efficiency");
    command->add_option("PLAN", arguments->plan, "Plan file, as select or plan writes it")
        ->required()
        ->check(file_name());
    command->add_option("--campaign", arguments->campaign, "Campaign file, if it is elsewhere now");
    command->add_option("--from", arguments->estimate, "As of select, if it is elsewhere now");
    command->add_option("-m,--measurements,--candidates,--blocks", arguments->candidates,
                        "File of the candidates, if it is elsewhere now");
    command->add_option("--augment", arguments->augment, "As of select, if it is elsewhere now");
    command->add_option("--groups", arguments->groups, "As of select, if it is elsewhere now");
    command->add_option("--test-poses", arguments->test_poses,
                        "As of select, if it is elsewhere now");
    command
        ->add_option("--targets", arguments->targets,
                     "If all is as stated, write where an instrument finds each target (CSV), as "
                     "plan --targets does")
        ->check(file_name());
    command->footer(verify_footer);
    command->callback([arguments, &common] { verify_file(*arguments, common); });
}

}  // namespace posewise::cli
