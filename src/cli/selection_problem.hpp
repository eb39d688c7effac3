#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "posewise/io/campaign_file.hpp"
#include "posewise/io/plan_file.hpp"
#include "posewise/core/stop.hpp"
#include "posewise/selection/exchange.hpp"

namespace posewise::cli {

/// A selection problem with all its files read; what `select` solves and `verify` states again.
struct SelectionProblem {
    io::SelectionRequest request;  ///< complete, repeats as in the file if not asked for
    std::optional<io::CampaignFile> campaign;  ///< nothing for plain blocks
    std::vector<std::string> ids;              ///< of the candidates
    RowMatrixXd configurations;                ///< of the candidates; empty for plain blocks
    std::string checksum;                      ///< of all of the candidates' numbers
    Blocks blocks;
    std::unique_ptr<Blocks> test_poses;  ///< null: the candidates
    SelectOptions options;               ///< the problem's part; refers to test_poses
};

/// Of random candidates fewer are drawn if `stop` comes; the request returned says how many. Throws
/// InputError for files that cannot be used, or not together.
SelectionProblem read_problem(io::SelectionRequest request, const StopSignal& stop = {});

/// Index of a candidate. Throws InputError, beginning with `what`, if there is none of that id.
class CandidateIndex {
  public:
    explicit CandidateIndex(const std::vector<std::string>& ids);
    Index find(const std::string& id, const std::string& what) const;

  private:
    std::unordered_map<std::string, Index> index_;
};

}  // namespace posewise::cli
