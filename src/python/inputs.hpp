#pragma once

#include <optional>
#include <string>
#include <vector>

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

/// The campaign as poses are planned with: as the estimate at `path` found it, if there is one.
io::CampaignFile planned_campaign(const io::CampaignFile& campaign, const PlanRequest& request,
                                  std::optional<bool> prior, const std::string& estimate,
                                  bool is_forced, Sentences& warnings);

/// Measurements in a table; without those excluded.
io::MeasurementsFile read_measured(const std::string& path, const io::CampaignFile& campaign,
                                   const std::vector<std::string>& excluded, Sentences& warnings,
                                   const io::PointsSource& points = {});

/// Says what is doubtful about a calibration that something is built on; with faults it throws
/// InputError, unless it is forced.
JudgeCalibration judge(bool is_forced, Sentences& warnings);

/// Tables of a choice, "" where there is none.
struct ChoiceTables {
    CandidateKind kind = CandidateKind::Configurations;
    std::string candidates;  ///< for kinds Measurements and Configurations
    Index random_count = 0;  ///< for kind Random
    std::string held;
    std::string test_poses;
};
/// What choose() and verify() need besides the campaign.
struct ChoiceInputs {
    Candidates candidates;
    ChoiceOptions options;
};
ChoiceInputs read_choice(const ChoiceTables& tables, const io::CampaignFile& campaign,
                         const PlanRequest& request, const std::vector<Index>& groups,
                         Sentences& warnings);

/// Tables of a plan, "" where there is none.
struct PlanningTables {
    std::string held;
    std::string workspace;
};
/// What make_plan() and verify() need besides the campaign.
PlanningOptions read_planning(const PlanningTables& tables, const io::CampaignFile& campaign,
                              const PlanRequest& request, Sentences& warnings);

/// Matrices of a choice from plain blocks; those of no rows are none.
struct PlainBlocks {
    RowMatrixXd candidates;
    Index rows = 1;          ///< of each candidate
    RowMatrixXd held;        ///< known already, as rows
    Index held_count = 0;    ///< poses that these are of, each with as many
    RowMatrixXd test_poses;  ///< blocks as the candidates'
};
/// What choose() and verify() need of them.
ChoiceOptions read_plain(const PlainBlocks& blocks, const PlanRequest& request,
                         const std::vector<Index>& groups);

}  // namespace posewise::python
