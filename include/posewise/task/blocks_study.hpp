#pragma once

#include <string>
#include <vector>

#include "posewise/selection/choice.hpp"
#include "posewise/task/choice.hpp"

namespace posewise {

/// Candidates that somebody else chose, by index; one listed twice is measured twice.
struct OwnSubset {
    std::string name;
    std::vector<Index> poses;
};

/// What is asked of plain blocks. ChoiceOptions::criterion and pose_count are not looked at.
struct BlocksStudyOptions : ChoiceOptions {
    std::vector<Criterion> criteria{Criterion::D};
    /// The numbers K of poses. The sizes of `subsets` are added to them.
    std::vector<Index> pose_counts{};
    Index random_subsets = 200;  ///< for each count; 0: none
    std::vector<OwnSubset> subsets{};
};

/// How much some subset tells.
struct SubsetValue {
    double value = 0;       ///< criterion; minus infinity: parameters are not identified
    double efficiency = 0;  ///< against the bound for its count, see Choice::efficiency
};

/// Quantiles of random subsets, each of value and of efficiency.
struct RandomBand {
    Index subsets = 0;       ///< how many were drawn; 0: none, and no quantiles
    Index unidentified = 0;  ///< how many of them do not identify the parameters
    SubsetValue p5, p50, p95;
};

/// What K poses can tell by one criterion.
struct BlocksStudyRow {
    Index pose_count = 0;
    Criterion criterion = Criterion::D;
    Choice chosen;  ///< without poses if no K candidates identify the parameters
    RandomBand random;
    /// BlocksStudy::subsets with as many poses, by number, and their values.
    std::vector<std::pair<std::size_t, SubsetValue>> own;
};

/// Value and efficiency against the number of poses.
struct BlocksStudy {
    Index candidate_count = 0;
    Index parameter_count = 0;
    PlanRequest request;  ///< complete, but for criterion and pose count
    std::vector<Criterion> criteria;
    std::vector<OwnSubset> subsets;
    std::vector<BlocksStudyRow> rows;  ///< by pose count, then in the order of the criteria
    Ending ending = Ending::NotRun;
};

/// For each count and criterion: the best choice with its proven bound, as select_poses() finds it,
/// random subsets (the same ones for all criteria) and the caller's own ones. Independent of the
/// number of threads. If it is stopped, with the counts that are finished. Throws InputError for
/// options as choose() does, for groups and a least distance, which random subsets do not keep, for
/// own subsets that are no choice of these candidates, and if no count identifies the parameters.
BlocksStudy study(Blocks candidates, const BlocksStudyOptions& options);

}  // namespace posewise
