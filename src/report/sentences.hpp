#pragma once

#include <string>
#include <vector>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/task/answers.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/judgement.hpp"
#include "posewise/task/plan.hpp"
#include "posewise/task/study.hpp"

/// Sentences about a campaign and about results, as reports and messages use them.
namespace posewise::detail {

/// The model error of what is measured, lengths and angles: "0.1 mm and 0.1 mrad".
std::string describe_model_error(const Campaign& campaign);

/// Whether an earlier estimate tells more of the model error than of any robot is known.
bool is_told_by_estimate(const Plan& plan, const KnownWithin& known);

/// The noise and column scales that whitened, scaled numbers rest on; `repeats` samples each.
std::string describe_scaling(const Campaign& campaign, double repeats);

/// What is done by hand while a plan is measured: "3 runs, the reflector moved between them, all at
/// each of 2 stations"; empty: nothing.
std::string describe_by_hand(const Plan& plan, const Cell& cell);

/// Says, where little is proven about a choice, what tells more; empty where it is nearly optimal.
std::string describe_looseness(double efficiency, Index starts_at_best, Index starts);

/// "with --exclude 5: 0.16 instead of 38 mm held out".
std::string describe(const Cure& cure, const Campaign& campaign);

/// "corners of the board cover 71 % of the image, none at its top left or bottom right", after the
/// words that it shall begin with.
std::string describe_images(const std::string& begin, const std::vector<ImageCoverage>& images);

/// Says so if a study judges on fewer than least_judged poses somewhere; else empty.
std::string describe_least_judged(const Study& study);

/// Whether the model error was worth looking for: there are errors of the robot to identify.
bool is_model_error_found(const Calibration& calibration);

/// " (90 %: 5 to 14)"; empty if the ends are the same. `none` says that no number does.
std::string describe_ends(const CountBand& band, const std::string& none);

/// "the joints' repeatability: 0.1 mm, 60 % of the square": the largest of the parts whose squares
/// add up to that of the total; empty for a total of 0.
struct ErrorPart {
    double size = 0;
    const char* what = nullptr;
};
std::string describe_largest(const std::vector<ErrorPart>& parts, double total,
                             const AmountUnits& units);

/// "1 mm", "-0.5 mrad": a small error with its unit.
std::string format_error(double value, const AmountUnits& units);
inline std::string format_error(double value, bool is_angle) {
    return format_error(value, units_of(is_angle));
}

}  // namespace posewise::detail
