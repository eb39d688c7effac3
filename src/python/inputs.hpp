#pragma once

#include <optional>
#include <string>
#include <vector>

#include "keywords.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/planning.hpp"

/// What Python hands over: plain matrices, and tables and documents as files. Sentences that a user
/// should see are collected.
namespace posewise::python {

using Sentences = std::vector<std::string>;

/// An estimate that is built on. Throws InputError if it must not be used, unless it is forced.
Earlier read_earlier(const std::string& path, const Campaign& campaign, const EarlierUse& use,
                     bool is_forced, Sentences& warnings);

/// The campaign as poses are planned with: as the request's estimate found it, if there is one.
io::CampaignFile planned_campaign(const io::CampaignFile& campaign, const PlanCall& asked,
                                  const StopSignal& stop, Sentences& warnings);

/// Measurements in a table; without those excluded.
io::MeasurementsFile read_measured(const std::string& path, const io::CampaignFile& campaign,
                                   const std::vector<std::string>& excluded, Sentences& warnings,
                                   const io::PointsSource& points = {});

/// The same of several plans, one for each, see io::join_measurements(). `plan` is what they are
/// together; nothing: none is stated.
io::MeasurementsFile read_planned(const CalibrationCall& asked, const io::CampaignFile& campaign,
                                  std::optional<Plan>& plan, Sentences& warnings);

/// Says what is doubtful about a calibration that something is built on; with faults it throws
/// InputError, unless it is forced.
JudgeCalibration judge(bool is_forced, Sentences& warnings);

/// What choose() and verify() need besides the campaign, from the sources of the request.
struct ChoiceInputs {
    Candidates candidates;
    ChoiceOptions options;
};
ChoiceInputs read_choice(const PlanCall& asked, const io::CampaignFile& campaign,
                         Sentences& warnings);
/// What make_plan() and verify() need besides the campaign.
PlanningOptions read_planning(const PlanRequest& request, const io::CampaignFile& campaign,
                              Sentences& warnings);

/// Matrices of a choice from plain blocks; those of no rows are none.
struct PlainBlocks {
    RowMatrixXd candidates;
    Index rows = 1;          ///< of each candidate
    RowMatrixXd held;        ///< known already, as rows
    Index held_count = 0;    ///< poses that these are of, each with as many
    RowMatrixXd prior;       ///< rows whose information is known before
    RowMatrixXd test_poses;  ///< blocks as the candidates'
};
/// What choose() and verify() need of them.
ChoiceOptions read_plain(const PlainBlocks& blocks, const PlanRequest& request,
                         const std::vector<Index>& groups);

}  // namespace posewise::python
