#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "posewise/selection/choice.hpp"
#include "posewise/task/choice.hpp"

namespace posewise::detail {

/// A selection stated from its inputs: what choose() solves and verify() states again.
struct ChoiceProblem {
    PlanRequest request;  ///< complete
    CandidateKind kind = CandidateKind::Blocks;
    std::vector<std::string> ids;
    RowMatrixXd configurations;  ///< of the candidates; empty for plain blocks
    RowMatrixXd share;           ///< of samples that show each target; empty for plain blocks
    std::string checksum;        ///< of all of the candidates' numbers
    Parameters parameters;       ///< that blocks are linearised at; nothing for plain blocks
    Blocks blocks;
    /// What G and V predict; null: the candidates. With a common model error of V only what its
    /// mean square needs, one block.
    std::unique_ptr<Blocks> test_poses;
    std::optional<double> reading_deviation;  ///< with it: length that these are divided by, m
    SelectOptions options;                    ///< the problem's part; refers to test_poses
    std::vector<std::string> cell_doubts;     ///< as Plan::cell_doubts
};

/// The file that candidates are of, for messages.
const std::string& name_of(const PlanSources& sources);

/// Of random candidates fewer are used if `stop` comes. Throws InputError as choose().
ChoiceProblem state_choice(const Campaign& campaign, Candidates candidates,
                           const ChoiceOptions& options, const StopSignal& stop = {});
ChoiceProblem state_choice(Blocks candidates, const ChoiceOptions& options);

/// ChoiceOptions::judge of what measured candidates calibrate, if they are measured.
void judge_candidates(const Campaign& campaign, const std::optional<Measurements>& measured,
                      const ChoiceOptions& options);

std::vector<std::string> ids_of(const std::vector<PlannedPose>& poses);

/// Where poses are among the candidates, as often as they are measured.
std::vector<Index> candidates_of(const ChoiceProblem& problem,
                                 const std::vector<PlannedPose>& poses);
/// What poses among the candidates tell, with what was held.
MatrixXd information_of(const ChoiceProblem& problem, const std::vector<PlannedPose>& poses);
/// Where the accuracy is predicted: candidates, evenly taken.
RowMatrixXd workspace_of(const ChoiceProblem& problem);

/// Where some of the candidates are.
class CandidateIndex {
  public:
    CandidateIndex(const std::vector<std::string>& ids, const std::vector<std::string>& wanted);
    /// Of one of them. Throws InputError, beginning with `what`, if it is not among the candidates.
    Index find(const std::string& id, const std::string& what) const;

  private:
    std::unordered_map<std::string, Index> index_;
};

}  // namespace posewise::detail
