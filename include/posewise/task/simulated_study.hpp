#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/task/study.hpp"

namespace posewise {

/// A campaign to simulate, one of several that differ.
struct SimulatedCampaign {
    std::string variation;  ///< what it has of its own: "sensor.sigma_mm=0.05"; empty: it is alone
    Campaign campaign;      ///< what poses are chosen for and robots are calibrated with
    /// Robots are drawn from this one; it may have errors that the other does not know of, but the
    /// same joints and targets. Base and targets are the other's where it states none. Nothing: the
    /// other.
    std::optional<Campaign> truth{};
};

/// StudyOptions::splits and holdout are not looked at; random_subsets are those of each trial.
struct SimulatedStudyOptions : StudyOptions {
    SimulatedStudyOptions() {
        criteria = {Criterion::V};
        random_subsets = 1;
    }
    /// Robots drawn; with a precision at most.
    Index trials = 100;
    /// Half of the 95 % interval of planned against random, as part of the ratio, that is asked of
    /// every pose count and criterion (without random subsets that of the planned error's geometric
    /// mean); trials of a campaign end when it is reached. 0: all trials are run.
    double precision = 0;
    Index pool_count = 2000;  ///< configurations to choose from, less those the cell forbids
    Index test_count = 200;   ///< configurations of the workspace that each robot is judged at
    Index repeats = 1;        ///< samples of each configuration
    bool is_refined = false;  ///< planned as make_plan() does, not only chosen from the pool
};

/// Accuracy against number of poses for a robot that nobody has measured yet: draws robots
/// (draw_robot()), measures each at configurations chosen for the nominal one by each criterion and
/// at as many random ones, calibrates, and judges where the targets are at configurations of the
/// workspace that were not chosen for: true position, with model error and repeatability of one
/// visit, against the calibrated model's. The poses to choose from are those that the cell allows.
///
/// One study for each campaign, in their order, with a split for each robot; robots are as alike as
/// the campaigns are, draw by draw. Those that were stopped before their first robot are left out,
/// unless all were. Empty in a process of a crew that does not lead. The same result for any crew,
/// shards and order. Throws InputError for options out of range, for a
/// campaign that make_plan() would refuse or whose sensor has contacts, for one that another robot
/// is the truth of, and if the nominal poses do not identify the model for any pose count.
std::vector<Study> simulate_study(const std::vector<SimulatedCampaign>& campaigns,
                                  const SimulatedStudyOptions& options = {});

}  // namespace posewise
