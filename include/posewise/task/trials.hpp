#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "posewise/core/progress.hpp"
#include "posewise/core/types.hpp"
#include "posewise/criteria/criterion.hpp"

namespace posewise {

/// Trials that are alike but for their number: of one campaign, by the same options and seed. Two
/// series are the same if all of this is, and then so are the results of each trial, wherever it
/// runs.
struct TrialSeries {
    bool is_simulated = false;        ///< robots that were drawn; else subsets of what was measured
    std::string campaign;             ///< its name
    std::string variation;            ///< of the campaign: "sensor.sigma_mm=0.05"; empty: none
    std::string checksum;             ///< of all else that a trial's numbers depend on
    std::uint64_t seed = 1;           ///< trial i draws from streams of it and i
    std::vector<Criterion> criteria;  ///< by which poses are chosen
    std::vector<Index> pose_counts;   ///< in increasing order
    Index random_subsets = 0;         ///< of each count: in all, or (simulated) in each trial
    Index splits = 0;                 ///< of measured configurations
    Index test_count = 0;             ///< configurations that a trial is judged on
    std::vector<std::string> ids;     ///< of measured configurations

    bool operator==(const TrialSeries&) const = default;
};

/// What one trial found.
struct Trial {
    Index number = 0;  ///< in its series, from 0
    std::vector<double> values;
};

using VisitTrial = std::function<void(const Trial&)>;

/// Where finished trials are kept, so that they never run again. All functions throw if they
/// cannot; they are called by one thread at a time.
struct TrialStore {
    /// Visits all trials of the series that are finished, in the order of their numbers.
    std::function<void(const TrialSeries&, const VisitTrial&)> finished;
    /// Once this returns the trial is kept, whatever happens to the process.
    std::function<void(const TrialSeries&, const Trial&)> keep;
};

/// The part of all trials that is run: those of number `number` - 1, `number` - 1 + `count`, ...
struct Shard {
    Index number = 1;
    Index count = 1;

    bool has(Index trial) const { return trial % count == number - 1; }
};

/// One of the trials to run: its series, by position in a list, and its number in that.
struct TrialId {
    Index series = 0;
    Index number = 0;
};

/// Runs one trial; called by any thread, of any process of the crew.
using ComputeTrial = std::function<std::vector<double>(const TrialId&)>;
/// Takes the result of the trial at that position of a list; called by one thread at a time.
using AcceptTrial = std::function<void(std::size_t position, std::vector<double> values)>;
/// Runs trials, in any order, and returns when all are accepted, or after those in flight if it is
/// stopped. What one throws is thrown here.
using RunTrials =
    std::function<void(const std::vector<TrialId>&, const AcceptTrial&, const StopSignal& stop)>;

/// Who runs the trials of a study. It calls `lead` in the process that leads, with a function to
/// run trials by; other processes compute what the leader hands them until it returns. All
/// processes must come here with the same `compute`, and once only: those that do not lead may end
/// here.
using TrialCrew = std::function<void(const ComputeTrial& compute,
                                     const std::function<void(const RunTrials&)>& lead)>;

/// The crew of one process: the threads there are.
void run_on_threads(const ComputeTrial& compute, const std::function<void(const RunTrials&)>& lead);

}  // namespace posewise
