#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "posewise/task/doubts.hpp"
#include "posewise/task/judgement.hpp"

namespace posewise::detail {

/// A calibration whose doubts are to be cured, and the groups that were held out of it.
struct Doubted {
    const Campaign& campaign;
    const Measurements& measurements;
    const Estimate& estimate;
    const CrossValidation& held_out;
    LevenbergMarquardtOptions options{};  ///< of its identification, and of those to try
};

/// A calibration to try instead: of the campaign, of fewer measurements, with another loss.
struct CureTrial {
    Remedy remedy;
    Campaign campaign;
    Measurements measurements;
    LevenbergMarquardtOptions options{};
    bool learns_sizes = false;  ///< which predict better, not fit
};

/// Calibrates as the trial says and holds out as many groups; nothing unless that lowers the error
/// by 5 % and beyond chance at the points that both judge. What the trial leaves out, and what its
/// loss calls outliers, judges nothing.
std::optional<Cure> try_cure(const Doubted& doubted, const CureTrial& trial);

/// The one that is missed most where it is held out, if leaving it out takes what is left over
/// below a tenth. Nothing under a robust loss, which does that by itself.
std::optional<LoneConfiguration> find_lone_configuration(const Doubted& doubted);

/// What may be tried beside what a calibration tells by itself.
struct CureOptions {
    /// Nothing says that the model is at fault: only what is left out is tried, and a robust loss.
    bool only_exclusions = false;
    bool can_learn_sizes = false;
    std::vector<OtherCampaign> campaigns{};
};

/// Tries a robust loss, the configurations left out that are outlying or the one that looks worst,
/// or a sample that scatters, as `doubts` say, sizes that are learned, and richer errors. Where
/// another cure leaves much less than it does to leave the outlying out, they are it no more.
Cures find_cures(const Doubted& doubted, Doubts& doubts, const CureOptions& options);

}  // namespace posewise::detail
