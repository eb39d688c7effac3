#pragma once

#include <optional>
#include <string>

#include "page.hpp"
#include "plan_inputs.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/task/planning.hpp"

/// What plan says of the plan that it has written.
namespace posewise::cli {

struct MadePlan {
    const TargetPlanning& made;  ///< a plan of stated size is no target's
    const std::optional<SimulatedPlan>& simulated;
    const io::CampaignFile& campaign;
    const PlanningOptions& options;  ///< that made it
    std::string out;
};

/// Prints it, and then writes the page and draws the plot, if there are paths for them.
void report_plan(const MadePlan& plan, const std::string& page, const std::string& plot,
                 const CommonOptions& common);

/// What a page shows of a plan that make_plan() made, beside its document.
io::PagePart show_plan(const Plan& plan, const Campaign& campaign, const PlanningOptions& options);
/// The same of a choice from these inputs.
io::PagePart show_choice(const Plan& plan, const ChoiceInputs& inputs);

}  // namespace posewise::cli
