#include "plan_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "blocks_options.hpp"
#include "common.hpp"
#include "files.hpp"
#include "io/measurements/groups_file.hpp"
#include "measured.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::cli {
namespace {

/// Measurements and their plan, if they are a list of points.
InputPaths paths_of(const std::string& measurements, const PlanSources& sources) {
    return {"", measurements, sources.measured_plan, sources.points_unit};
}

/// Warns of poses that count as measured although calibrate judges on them.
void warn_of_verification(const std::string& path, const Plan& plan,
                          const std::vector<std::string>& ids) {
    const Index count = std::ranges::count_if(plan.verification, [&](const PlannedPose& pose) {
        return std::ranges::find(ids, pose.id) != ids.end();
    });
    if (count == 0) return;
    print_warning(
        fmt::format("{}: {} of {} poses were set aside to verify; they are counted here, "
                    "but calibrate holds them out: leave them out unless it shall not",
                    path, count, ids.size()));
}

/// Poses measured already, --augment.
std::optional<io::MeasurementsFile> read_held(const PlanRequest& request,
                                              const io::CampaignFile& campaign) {
    const PlanSources& sources = request.sources;
    if (sources.augment.empty()) return std::nullopt;
    const InputPaths paths = paths_of(sources.augment, sources);
    const std::optional<Plan> plan = read_measured_plans(paths, campaign).all;
    io::MeasurementsFile held = read_measured(sources.augment, campaign, points_of(paths, plan));
    warn_of_counting_twice(sources.estimate, request.earlier.is_prior, sources.augment, held);
    if (plan && held.is_joined) warn_of_verification(sources.augment, *plan, held.ids);
    return held;
}

/// `is_joined` is set where they are a list of points.
Candidates read_candidates(const PlanSources& sources, CandidateKind kind,
                           const io::CampaignFile& campaign, bool& is_joined) {
    if (kind == CandidateKind::Measurements) {
        const InputPaths paths = paths_of(sources.candidates, sources);
        const io::MeasurementsFile read =
            read_measured_without({}, paths, campaign, {}, read_measured_plans(paths, campaign));
        is_joined = read.is_joined;
        return measured_candidates(read);
    }
    io::Configurations read = io::read_configurations(sources.candidates, campaign);
    return {kind, std::move(read.ids), std::move(read.joints), read.is_seen.cast<double>(),
            std::nullopt};
}

void read_plain(ChoiceInputs& inputs) {
    ChoiceOptions& options = inputs.options;
    PlanSources& sources = options.sources;
    io::BlocksFile candidates = read_blocks(sources.candidates, sources);
    sources.rows_per_block = candidates.rows_per_block;
    inputs.blocks = std::move(candidates.blocks);
    if (!sources.augment.empty()) {
        options.held_blocks = read_blocks(sources.augment, sources).blocks;
    }
    if (!sources.test_poses.empty()) {
        options.test_blocks = read_blocks(sources.test_poses, sources).blocks;
    }
}

void read_with_robot(ChoiceInputs& inputs, CandidateKind kind, Index count) {
    ChoiceOptions& options = inputs.options;
    const PlanSources& sources = options.sources;
    const io::CampaignFile& campaign = *inputs.campaign;
    bool is_joined = false;
    if (kind != CandidateKind::Random) {
        inputs.candidates = read_candidates(sources, kind, campaign, is_joined);
    }
    if (const auto held = read_held(options, campaign)) {
        options.held = *held;
        is_joined |= held->is_joined;
    }
    const bool has_measured = kind == CandidateKind::Measurements;
    const InputPaths paths = paths_of(has_measured ? sources.candidates : sources.augment, sources);
    check_needs_unit(paths, is_joined);
    check_needs_plan(paths, is_joined);
    if (kind == CandidateKind::Random) {
        inputs.candidates =
            random_candidates(campaign, count, options.seed.value_or(campaign.seed));
    }
    if (!sources.test_poses.empty()) {
        options.test_poses = io::read_configurations(sources.test_poses, campaign).joints;
    }
}

/// Names of the candidates; those of plain blocks are numbers.
std::vector<std::string> ids_of(const ChoiceInputs& inputs) {
    if (inputs.campaign) return inputs.candidates.ids;
    std::vector<std::string> ids;
    for (Index i = 0; i < inputs.blocks.count(); ++i) ids.push_back(std::to_string(i));
    return ids;
}

}  // namespace

ChoiceInputs read_choice_inputs(const PlanRequest& request, CandidateKind kind, Index count,
                                std::optional<io::CampaignFile> campaign) {
    ChoiceInputs inputs;
    inputs.campaign = std::move(campaign);
    static_cast<PlanRequest&>(inputs.options) = request;
    if (inputs.campaign) {
        read_with_robot(inputs, kind, count);
    } else {
        read_plain(inputs);
    }
    const std::string& groups = request.sources.groups;
    if (!groups.empty()) inputs.options.groups = detail::read_groups(groups, ids_of(inputs));
    return inputs;
}

PlanningOptions read_planning_inputs(const PlanRequest& request, const io::CampaignFile& campaign) {
    PlanningOptions options;
    static_cast<PlanRequest&>(options) = request;
    const PlanSources& sources = request.sources;
    if (!sources.repaired.empty() && sources.repaired == sources.measured_plan) {
        throw input_error_at({sources.augment},
                             "was measured at the poses of the plan to repair, which are kept "
                             "anyway and would count twice; --augment must be left out");
    }
    if (const auto held = read_held(options, campaign)) {
        const InputPaths paths = paths_of(sources.augment, sources);
        check_needs_unit(paths, held->is_joined);
        check_needs_plan(paths, held->is_joined, "--augment-plan");
        options.held = *held;
    }
    if (!sources.workspace.empty()) {
        options.workspace = io::read_configurations(sources.workspace, campaign).joints;
    }
    return options;
}

VectorXd program_steps(io::ProgramFormat format, const io::CampaignFile& campaign) {
    const std::string& maker = campaign.controller_maker;
    const std::string_view name = io::program_format_name(format);
    if (!maker.empty() && maker != name && format != io::ProgramFormat::Csv) {
        throw input_error_at(
            {campaign.path},
            fmt::format("controller.maker is {}, the program is for {}; must be of "
                        "its controller, or be left out where that counts joints "
                        "as the model does",
                        maker, name));
    }
    return compute_from(campaign.path,
                        [&] { return io::joint_steps(format, campaign.controller); });
}

}  // namespace posewise::cli
