#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/task/limit.hpp"

/// How a calibration does at poses that were measured to judge it.
namespace posewise {

/// How poses that a calibration is judged at relate to those that it was made with.
enum class PoseGroup {
    New,       ///< within the ranges of the joints calibrated with
    Beyond,    ///< outside of them: what is expected there is an extrapolation
    Repeated,  ///< equal to poses calibrated with: they say nothing about others
};

/// What an error found is beside the one expected.
enum class ChanceVerdict {
    NotJudged,  ///< no error is expected, or the poses are repeated ones
    Within,
    Below,   ///< smaller than chance would have it
    Beyond,  ///< larger
};

/// Where the RMS over all such poses is with 95 %, by those that were measured: chi-squared.
struct RmsInterval {
    double lower = 0;  ///< m; rad where no length is measured
    double upper = 0;
    /// ErrorFreedom::of_poses, less what of base and targets was fitted to these poses.
    double degrees_of_freedom = 0;
};

/// A set-up that is another one than that calibrated with.
struct Moved {
    std::vector<std::string> parts;  ///< that it takes to say so: "base", "targets" or both
    double base = 0;                 ///< m
    double targets = 0;              ///< the farthest of them in the flange frame, m
};

/// One that has more than half of the squares of a group beyond chance.
struct WorstConfiguration {
    std::string id;
    double without = 0;  ///< RMS of the others, m or rad
};

/// The poses of one group, judged by themselves.
struct JudgedGroup {
    PoseGroup group = PoseGroup::New;
    std::vector<Index> configurations;      ///< of the measurements judged, from 0
    std::vector<std::string> joints;        ///< of Beyond: those that leave their ranges
    Metrics found;                          ///< of all samples
    std::optional<ExpectedError> expected;  ///< nothing where the estimate does not tell
    /// Nothing where as much was fitted to these poses as they tell.
    std::optional<RmsInterval> interval;
    /// The factor by which found and expected may differ by chance: two standard deviations of the
    /// model error found and of the freedom of these poses, at least 1.25.
    double chance = 1;
    ChanceVerdict verdict = ChanceVerdict::NotJudged;
    std::optional<WorstConfiguration> worst;

    /// Found against expected.
    double ratio() const { return found.rms() / expected.value().total(); }
};

/// All poses of one kind, and each group of them that there is, in the order of PoseGroup.
struct Judgement {
    Metrics found;
    std::optional<ExpectedError> expected;
    std::vector<JudgedGroup> groups;
    /// Where one of them is beyond chance, what has plainly moved since the calibration.
    std::optional<Moved> moved;

    bool is_beyond() const {
        return std::ranges::any_of(groups, [](const JudgedGroup& group) {
            return group.verdict == ChanceVerdict::Beyond;
        });
    }
};

/// By the interval's ends; nothing for repeated poses, and where there is no interval.
std::optional<LimitVerdict> judge_limit(const JudgedGroup& group, double limit);
/// Where the limit is within the interval: so many poses would decide, if their RMS were the same.
/// Nothing where over 1000 would not.
std::optional<Index> poses_to_decide(const JudgedGroup& group, double limit);

}  // namespace posewise
