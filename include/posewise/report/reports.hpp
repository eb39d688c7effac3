#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/task/calibration.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/correction.hpp"
#include "posewise/task/inspection.hpp"
#include "posewise/task/planning.hpp"
#include "posewise/task/simulated_plan.hpp"
#include "posewise/task/study.hpp"
#include "posewise/task/target.hpp"
#include "posewise/task/verification.hpp"

/// What tasks found, as text: all that the program prints of it.
namespace posewise {

/// Elements, joints and axes of a robot, as text.
std::string format_robot(const Chain& robot);

/// The robot, and which of its errors can be found: every parameter with its expected error and, if
/// no measurement can tell it from others, the errors that do the same, as text.
std::string format(const Inspection& inspection);

/// Every index of measured configurations to so many significant digits, and the directions they
/// hardly tell, as text: all that `posewise indices` prints.
std::string format(const Rating& rating, const Campaign& campaign, int digits = 6);

/// "target 1 lies on the axis of joint_6, ...".
std::string describe(const OnAxis& on_axis);

/// Says that there is no clear gap between what is identifiable and what is not, where that is so.
std::string describe_gap(const Inspection& inspection);

/// What was identified, how accurate the robot is with it and how sure each parameter is, as text:
/// all that `posewise calibrate` prints. More than 50 errors of the robot are summed up by class,
/// unless all shall be listed. Of a calibration that is not identified, why.
std::string format(const Calibration& calibration, bool has_all_parameters = false);

/// Parameter sets side by side, and which is recommended.
std::string format(const ModelSelection& selection);

/// One sentence each: what looks wrong with the measurements, which `measurements` names if it is
/// not empty, or with the errors found. What format() says already is not repeated.
std::vector<std::string> describe_doubts(const Calibration& calibration,
                                         const std::string& measurements = "");

/// "2 of 24 configurations are beyond ..."; `ids` are those of all.
std::string describe(const BeyondLimits& beyond, const std::vector<std::string>& ids);

/// "q1 and q7 are the same in all configurations: ..."; empty for no joints.
std::string describe_still_joints(const Campaign& campaign, const std::vector<Index>& joints);

/// The pose error with and without correction (mm, mrad), by how much joints change, and the first
/// twenty poses whose correction is not complete, with the reason, as text.
std::string format(const CorrectedPoses& poses);

/// What was chosen, its value to so many significant digits, and what is proven about it, a line
/// each.
std::string format_choice(const Plan& plan, int digits = 8);

/// Weights instead of a choice, and the bound they prove.
std::string format(const ApproximateDesign& design, int digits = 8);

/// What was planned, how good it is, and the poses in visiting order.
std::string format_planning(const Planning& planning);

/// What the expected position error consists of.
std::string format_budget(const Planning& planning);

/// How a target was reached, a line or two.
std::string format(const TargetPlanning& found);
/// What each number of poses is expected to reach, and how long it takes.
std::string format_curve(const TargetPlanning& found);
/// Why a target was not reached and what would help, as one sentence; empty if it was.
std::string describe_shortfall(const TargetPlanning& found);

/// What was predicted beside what was found on robots that were drawn, and how sure that is.
std::string format(const SimulatedPlan& simulated);
/// Whether the target's limit is kept by that, in one line; empty without them.
std::string describe_verified(const TargetOptions& target,
                              const std::optional<SimulatedPlan>& simulated);

/// Predicted accuracy for other numbers of poses.
std::string format_other_counts(const std::vector<CountAccuracy>& counts, const Campaign& campaign);

/// Expected standard deviation of each parameter.
std::string format_deviations(const Plan& plan);

/// A line for each finding: "value:      as stated, -12.345678".
std::string format_findings(const std::vector<Finding>& findings);

/// The table as text, or why there is nothing to study.
std::string format(const Study& study);

/// The studies of several error models (compare_models()) in one table, or why one of them cannot
/// be studied.
std::string format(const std::vector<Study>& studies);

/// Takes a part of a text.
using WriteText = std::function<void(std::string_view)>;

/// Every case of a study as CSV text, some lines at a time: pose count, who chose (criterion or
/// "random"), number of the subset (planned: of its split), whether it identified the model,
/// held-out distance RMS and maximum in mm (9 digits), and the configurations by id, separated by
/// blanks.
void write_study_csv(const Study& study, const WriteText& write);
/// The same of several error models, with the model as first column.
void write_study_csv(const std::vector<Study>& studies, const WriteText& write);

}  // namespace posewise
