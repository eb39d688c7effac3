#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/calibrator/identification.hpp"

/// Judging predictions at configurations that took no part in them.
namespace posewise {

/// How far held-out configurations are missed by robots fitted to the others: by the calibrated
/// robot, and by the nominal one with only base and targets fitted. The same groups are held out.
/// RMS of means; m, of angles (rad) where no length is measured.
struct HeldOutComparison {
    double calibrated = 0;
    double nominal = 0;
    /// Wilcoxon's signed ranks of log(calibrated / nominal), one number per configuration, in their
    /// standard deviations by chance [Wilcoxon 1945]. Above 0: the nominal robot is better. One
    /// gross error moves it little.
    double rank_deviations = 0;
    Index configurations = 0;  ///< number compared

    /// Worse beyond chance: once in 200 campaigns whose calibration changes nothing.
    bool is_worse() const;
    /// Not shown to be better, at the level of once in 20 of them. False for fewer than five
    /// configurations, which can show nothing.
    bool is_no_better() const;
};

/// What to calibrate with instead: an option ("exclude 5", "loss cauchy", "sizes learned") or a
/// campaign key ("robot.errors: full").
struct Remedy {
    std::string words;
    bool is_key = false;

    bool operator==(const Remedy&) const = default;
};
Remedy exclusion(const std::vector<std::string>& ids);
/// As a user types it: "--exclude 5", "robot.errors: full".
std::string spell(const Remedy& remedy);

/// A remedy that was tried: it lowers the held-out error by 5 % and beyond chance (once in 100
/// remedies that change nothing, by signed ranks).
struct Cure {
    Remedy remedy;
    double before = 0;  ///< RMS of the means held out; m, or rad where no length is measured
    double after = 0;   ///< likewise with it, for what it does not leave out
};

/// What was tried against the doubts about a calibration.
struct Cures {
    std::vector<Cure> found;  ///< the best first
    /// Those that do not lower the error beyond chance, or leave over 1.5 times as much as the
    /// best.
    std::vector<Remedy> without_effect;
};

/// A campaign as its file would state it with another key, to try.
struct OtherCampaign {
    std::string key;  ///< "robot.errors: full"
    Campaign campaign;
};

/// A configuration without which the others fit at least ten times better.
struct LoneConfiguration {
    std::string id;
    double before = 0;  ///< RMS of means for all; m, or rad where no length is measured
    double after = 0;   ///< for the others without it
};

/// Whether an error known within an interval keeps a limit.
enum class LimitVerdict {
    Kept,     ///< the whole interval is at or below it
    NotKept,  ///< the whole interval is above it
    Open,     ///< the limit is within the interval
};

// How a calibration performs at poses that were measured to judge it.

/// How the poses that a calibration is judged at relate to those it was made with.
enum class PoseGroup {
    New,       ///< within the ranges of the joints calibrated with
    Beyond,    ///< outside of them: the expected error is an extrapolation
    Repeated,  ///< equal to poses calibrated with: they say nothing about others
};

/// How the error found compares with the expected one.
enum class ChanceVerdict {
    NotJudged,  ///< no error is expected, or repeated poses that are not Beyond
    Within,
    Below,   ///< smaller than by chance
    Beyond,  ///< larger
};

/// 95 % interval of the RMS over all such poses, from those measured: chi-squared.
struct RmsInterval {
    double lower = 0;  ///< m; rad where no length is measured
    double upper = 0;
    /// ErrorFreedom::of_poses, less what of base and targets was fitted to these poses.
    double degrees_of_freedom = 0;
};

/// A set-up that is not the one calibrated with.
struct Moved {
    std::vector<std::string> parts;  ///< parts that explain it: "base", "targets" or both
    double base = 0;                 ///< m
    double targets = 0;              ///< the farthest of them in the flange frame, m
};

/// A configuration with more than half of the squares of a group that is beyond chance.
struct WorstConfiguration {
    std::string id;
    double without = 0;  ///< RMS of the others, m or rad
};

/// The poses of one group, judged by themselves.
struct JudgedGroup {
    PoseGroup group = PoseGroup::New;
    std::vector<Index> configurations;      ///< indices in the measurements judged
    std::vector<std::string> joints;        ///< for Beyond: those that leave their ranges
    Metrics found;                          ///< over all samples
    std::optional<ExpectedError> expected;  ///< nothing if the estimate cannot say
    /// Nothing if as many numbers were fitted to these poses as they provide.
    std::optional<RmsInterval> interval;
    /// Factor by which found and expected may differ by chance: two standard deviations, from
    /// that of the model error found and the freedom of these poses; at least 1.25.
    double chance = 1;
    ChanceVerdict verdict = ChanceVerdict::NotJudged;
    std::optional<WorstConfiguration> worst;
    /// RMS of the nominal robot there, base and targets fitted to what they were fitted to for
    /// `found`.
    std::optional<double> nominal;

    /// Found / expected.
    double ratio() const { return found.rms() / expected.value().total(); }
    /// Whether nothing was gained there.
    bool is_no_better() const { return nominal && found.rms() >= *nominal; }
};

/// All poses of one kind, and their groups, in the order of PoseGroup.
struct Judgement {
    Metrics found;
    /// Units of its errors: a validation may be measured by another kind of sensor.
    const AmountUnits* units = &length_units;
    std::optional<ExpectedError> expected;
    std::vector<JudgedGroup> groups;
    /// If one of them is beyond chance: what has plainly moved since the calibration.
    std::optional<Moved> moved;

    bool is_beyond() const {
        return std::ranges::any_of(groups, [](const JudgedGroup& group) {
            return group.verdict == ChanceVerdict::Beyond;
        });
    }
};

/// By the interval's ends; nothing for repeated poses or without an interval.
std::optional<LimitVerdict> judge_limit(const JudgedGroup& group, double limit);
/// If the limit is within the interval: the number of poses that would decide, with the same RMS.
/// Nothing if over 1000 would not.
std::optional<Index> poses_to_decide(const JudgedGroup& group, double limit);

}  // namespace posewise
