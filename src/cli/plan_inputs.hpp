#pragma once

#include <optional>

#include "posewise/io/campaign_file.hpp"
#include "posewise/io/robot_programs.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/planning.hpp"

/// The files that a plan's sources name, for those who make it and for verify.
namespace posewise::cli {

/// A choice with its files read.
struct ChoiceInputs {
    std::optional<io::CampaignFile> campaign;  ///< nothing for plain blocks
    Candidates candidates;
    Blocks blocks;  ///< plain candidates
    ChoiceOptions options;
};

/// Reads what the request's sources name; `count` is that of random candidates. Throws InputError
/// for files that cannot be used, or not together.
ChoiceInputs read_choice_inputs(const PlanRequest& request, CandidateKind kind, Index count,
                                std::optional<io::CampaignFile> campaign);

/// Likewise of a continuous plan, but for the plan to repair.
PlanningOptions read_planning_inputs(const PlanRequest& request, const io::CampaignFile& campaign);

/// The steps of a program's joints. Throws InputError if the campaign's controller is another's:
/// drivers of ROS, for one, take the model's joints, not those of FANUC's pendant.
VectorXd program_steps(io::ProgramFormat format, const io::CampaignFile& campaign);

}  // namespace posewise::cli
