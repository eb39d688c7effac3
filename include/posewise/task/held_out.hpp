#pragma once

#include <string>
#include <vector>

#include "posewise/calibrator/identification.hpp"

/// What configurations tell that took no part in what predicts them.
namespace posewise {

/// How far configurations are missed by robots that others of them were fitted with, the same
/// groups held out: by the calibrated robot, and by the nominal one, of which base and targets
/// alone are fitted. RMS of means; m, of angles (rad) where no length is measured.
struct HeldOutComparison {
    double calibrated = 0;
    double nominal = 0;
    /// Wilcoxon's signed ranks of log(calibrated / nominal), one number a configuration, in their
    /// standard deviations by chance [Wilcoxon 1945]; above 0: the nominal robot is better. One
    /// gross error moves it little.
    double rank_deviations = 0;
    Index configurations = 0;  ///< that were compared

    /// Beyond chance: once in 200 campaigns whose calibration changes nothing.
    bool is_worse() const;
    /// Not shown to be better, by what would seem so once in 20 of them. Of fewer than five
    /// configurations nothing can be shown, and it is false.
    bool is_no_better() const;
};

/// An option of `calibrate`, or a key of the campaign, that was tried: the error held out is lower
/// with it, by 5 % and beyond chance (once in 100 cures that change nothing, by signed ranks).
struct Cure {
    std::string option;  ///< "--exclude 5", "robot.errors: full"
    double before = 0;   ///< RMS of the means held out; m, or rad where no length is measured
    double after = 0;    ///< the same with it, of what it does not leave out
};

/// What was tried against the doubts about a calibration.
struct Cures {
    std::vector<Cure> found;  ///< the best first
    /// Options that do not lower the error beyond chance, or leave half as much again as the best.
    std::vector<std::string> without_effect;
};

/// A campaign that its file would state with another key: what to try.
struct OtherCampaign {
    std::string option;  ///< "robot.errors: full"
    Campaign campaign;
};

/// A configuration without which the others fit at least ten times better.
struct LoneConfiguration {
    std::string id;
    double before = 0;  ///< RMS of means that all leave; m, or rad where no length is measured
    double after = 0;   ///< that the others leave without it
};

}  // namespace posewise
