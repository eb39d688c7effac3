#pragma once

#include <string>
#include <vector>

#include "posewise/measurement/campaign.hpp"
#include "posewise/selection/choice.hpp"

namespace posewise::io {

/// Where the candidates of a selection come from.
struct CandidateSource {
    enum class Kind {
        Measurements,    ///< measured configurations; base and targets registered from them
        Configurations,  ///< a list of configurations
        Random,          ///< scrambled Halton sequence within the joint limits
        Blocks,          ///< a plain matrix, no robot
    };
    Kind kind = Kind::Measurements;
    std::string campaign;      ///< campaign file; empty for Blocks
    std::string path;          ///< file of the candidates; empty for Random
    Index count = 0;           ///< of Random
    std::uint64_t seed = 1;    ///< of Random
    Index rows_per_block = 0;  ///< of Blocks
    std::string variable;      ///< of Blocks in a MATLAB file; empty: the first
    double repeats = 0;        ///< samples of each chosen configuration; 0: as in the file
};

/// A selection problem as it is asked for; all it takes to state it again. Files that are not used
/// are empty.
struct SelectionRequest {
    CandidateSource source;
    Criterion criterion = Criterion::D;
    Index pose_count = 0;
    bool has_prior = false;            ///< the scale is the prior standard deviation too
    bool is_focused_on_robot = false;  ///< base and targets are nuisance
    std::string augment;               ///< poses measured already: held, not chosen again
    std::string test_poses;            ///< of G and V; empty: the candidates
    std::string groups;                ///< group of each candidate
    Index group_limit = 0;
    std::vector<std::string> excluded;  ///< ids
    Index repeat_limit = 1;
    double least_distance = 0;  ///< rad, Euclidean over the turning joints
};

/// A chosen candidate.
struct PlannedPose {
    std::string id;
    Index times = 1;
    VectorXd joints;  ///< the configuration, rad, m and N m; empty for plain blocks
};

/// What a plan file holds.
struct PlanFile {
    SelectionRequest request;
    Index candidate_count = 0;
    std::string checksum;  ///< of the candidates' numbers and ids
    std::vector<PlannedPose> poses;
    /// What select_poses() said; `plan.poses` is not stored (the ids are) and empty when read.
    Choice plan;
};

/// Writes a plan as JSON: what was asked for, value, bound, efficiency and the matrix that proves
/// the bound, how it was made, what it assumes (noise, scales; `campaign` is null for plain
/// blocks), and the poses. Relative paths are stored as seen from the plan's folder; infinite
/// numbers are null.
void write_plan(const std::string& path, const PlanFile& file, const Campaign* campaign);

/// Reads a plan. Relative paths lead from the plan's folder or else from the current one. Throws
/// InputError with the place for whatever is missing, of another type or out of range.
PlanFile read_plan(const std::string& path);

/// Only the poses of a plan file, in order; of a pose plan, too. Throws InputError for a file that
/// is neither.
std::vector<PlannedPose> read_plan_poses(const std::string& path);

/// What a plan or pose plan states to assume (noise, scales) and the campaign does not, one line
/// each: "sigma_m: stated 1e-05, is 5.2e-05". Throws InputError as read_plan().
std::vector<std::string> find_changed_assumptions(const std::string& path,
                                                  const Campaign& campaign);

}  // namespace posewise::io
