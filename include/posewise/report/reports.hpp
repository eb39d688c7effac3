#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/task/answers.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/correction.hpp"
#include "posewise/task/inspection.hpp"
#include "posewise/task/planning.hpp"
#include "posewise/task/study.hpp"

/// Results of tasks as text: everything that the program prints of them.
namespace posewise {

/// What people ask of a result first; the first answer sums it up. Empty for a result without
/// figures.
std::vector<Answer> answer(const Calibration& calibration);
std::vector<Answer> answer(const Planning& planning, const std::vector<CountAccuracy>& counts = {},
                           const std::optional<SimulatedPlan>& simulated = std::nullopt);
std::vector<Answer> answer(const TargetPlanning& found,
                           const std::optional<SimulatedPlan>& simulated = std::nullopt);
std::vector<Answer> answer(const Plan& choice);
std::vector<Answer> answer(const std::vector<Study>& studies);
std::vector<Answer> answer(const BlocksStudy& study);
/// A paragraph for each, 100 columns wide, and an empty line.
std::string format(const std::vector<Answer>& answers);

/// Elements, joints and axes of a robot, as text.
std::string format_robot(const Chain& robot);

/// The robot and which of its errors can be found: every parameter with its expected error and, if
/// no measurement can tell it from others, the errors that do the same.
std::string format(const Inspection& inspection);

/// Every index of measured configurations with `digits` significant digits, and the directions they
/// hardly show: everything that `posewise indices` prints.
std::string format(const Rating& rating, const Campaign& campaign, int digits = 6);
/// As above for plain blocks; `names` has one for each parameter.
std::string format(const Rating& rating, const std::vector<std::string>& names, bool has_prior,
                   int digits = 6);

/// "target 1 lies on the axis of joint_6, ...".
std::string describe(const OnAxis& on_axis);
/// Empty where there are none.
std::string describe_narrow_limits(const Campaign& campaign, const std::vector<Index>& joints);

/// Says that there is no clear gap between what is identifiable and what is not, if so.
std::string describe_gap(const Inspection& inspection);

/// What was identified, the robot's accuracy with it and the uncertainty of each parameter:
/// everything that `posewise calibrate` prints. More than 50 robot errors are summarised by class,
/// unless `has_all_parameters`. If the calibration is not identified, the reason.
std::string format(const Calibration& calibration, bool has_all_parameters = false);

/// Parameter sets next to each other, and which one is recommended.
std::string format(const ModelSelection& selection);

/// What looks wrong with the measurements, or with the errors found, one sentence each; they name
/// `measurements` unless it is empty. Does not repeat what format() says.
std::vector<std::string> describe_doubts(const Calibration& calibration,
                                         const std::string& measurements = "");

/// "2 of 24 configurations are beyond ..."; `ids` are those of all configurations.
std::string describe(const BeyondLimits& beyond, const std::vector<std::string>& ids);

/// "q1 and q7 are the same in all configurations: ..."; empty for no joints.
std::string describe_still_joints(const Campaign& campaign, const std::vector<Index>& joints);

/// The pose error with and without correction (mm, mrad), the changes of the joints, and the first
/// twenty poses whose correction is not complete, with the reason.
std::string format(const CorrectedPoses& poses);

/// What was chosen, its value with `digits` significant digits, and what is proven about it, one
/// line each.
std::string format_choice(const Plan& plan, int digits = 8);

/// Weights instead of a choice, and the bound they prove.
std::string format(const ApproximateDesign& design, int digits = 8);

/// What was planned, how good it is, and the poses in visiting order.
std::string format_planning(const Planning& planning);

/// What the expected position error consists of.
std::string format_budget(const Planning& planning);

/// How a target was reached, in one or two lines.
std::string format(const TargetPlanning& found);
/// What each number of poses is expected to reach, and how long it takes.
std::string format_curve(const TargetPlanning& found);
/// Why a target was not reached and what would help, as one sentence; empty if it was.
std::string describe_shortfall(const TargetPlanning& found);

/// Predictions next to what was found on simulated robots, and how certain that is.
std::string format(const SimulatedPlan& simulated);
/// Whether that keeps the target's limit, in one line; empty without limit or simulation.
std::string describe_verified(const TargetPlanning& found,
                              const std::optional<SimulatedPlan>& simulated);

/// Predicted accuracy for other numbers of poses.
std::string format_other_counts(const std::vector<CountAccuracy>& counts);

/// Expected standard deviation of each parameter.
std::string format_deviations(const Plan& plan);

/// One line per finding: "value:      as stated, -12.345678".
std::string format_findings(const std::vector<Finding>& findings);

/// The table as text, or why there is nothing to study.
std::string format(const Study& study);

/// The studies of several error models (compare_models()) in one table, or why one of them cannot
/// be studied.
std::string format(const std::vector<Study>& studies);

/// That a study was stopped before all was finished, in words; empty if it was not. Throws
/// InputError if nothing was finished by then.
std::string describe_early_end(const Study& study);
/// What to warn of if it judges on fewer than least_judged configurations; else empty.
std::string describe_few_judged(const Study& study);

/// Receives a part of a text.
using WriteText = std::function<void(std::string_view)>;

/// Writes every case of a study as CSV, some lines at a time: pose count, who chose (criterion or
/// "random"), number of the subset (planned: of its split), whether it identified the model,
/// held-out distance RMS and maximum in mm (9 digits), and the ids of the configurations, separated
/// by blanks.
void write_study_csv(const Study& study, const WriteText& write);
/// As above for several error models, with the model as first column.
void write_study_csv(const std::vector<Study>& studies, const WriteText& write);

/// Chosen, random and own subsets of plain blocks, a line for each pose count and criterion.
std::string format(const BlocksStudy& study, int digits = 6);
/// As for other studies.
std::string describe_early_end(const BlocksStudy& study);
/// Writes it as CSV, a line for each subset: poses, criterion, who chose ("best", "random 5 %",
/// "random 50 %", "random 95 %", or the name of an own subset), value, bound, efficiency,
/// candidates.
void write_study_csv(const BlocksStudy& study, const WriteText& write);

}  // namespace posewise
