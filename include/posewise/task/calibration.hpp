#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "posewise/calibrator/identification.hpp"
#include "posewise/calibrator/model_selection.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/task/doubts.hpp"
#include "posewise/task/earlier.hpp"
#include "posewise/task/judgement.hpp"

namespace posewise {

/// How parameters are identified.
enum class CalibrationMethod {
    Joint,    ///< all together, identify()
    TwoStep,  ///< identify_two_step(): to compare with the literature
    Global,   ///< identify_globally(): a robot that is far from nominal
};
/// "lm", "two-step", "global".
std::string_view method_name(CalibrationMethod method);

struct CalibrationOptions {
    CalibrationMethod method = CalibrationMethod::Joint;
    /// Of the joint identification; its loss also of the nominal fit and of what is held out. Other
    /// methods know squares only.
    LevenbergMarquardtOptions joint{};
    TwoStepOptions two_step{};
    GlobalOptions global{};
    /// Configurations to calibrate with, such as those of a plan; it is judged on the others, too.
    /// Empty: all.
    std::vector<Index> used{};
    /// Configurations that are not used but to judge by themselves, such as the poses that a plan
    /// has to verify; none of `used`, which must be stated.
    std::vector<Index> verification{};
    /// What was left out of the measurements by hand, with leave_out(): for the record.
    std::vector<std::string> excluded{};
    /// Needs Joint.
    std::optional<Earlier> earlier{};
    /// More measurements, to judge on only; the caller keeps them alive. Null: none.
    const Measurements* validation = nullptr;
    /// What is identified anew for them, since they were measured with another set-up: "base",
    /// "targets" or both. The rest stays. Empty: nothing.
    std::vector<std::string> refitted{};
    /// The campaign they are of: the same robot, perhaps with another payload, and its errors, but
    /// other targets or another sensor. Then base and targets must both be refitted. Null: the
    /// same.
    const Campaign* validation_campaign = nullptr;
    /// That the RMS of distances is to keep where the calibration is judged (judge_limit()), m.
    std::optional<double> limit{};
    /// Configurations that need not be measured, to say what to expect there (m x joints, and
    /// measured torques; rad, m, N m). Empty: none.
    RowMatrixXd predicted{};
    /// Groups of configurations to hold out in turn; 0: none. Nothing: default_folds().
    std::optional<Index> folds{};
    bool model_selection = false;  ///< compare nested parameter sets, too; needs folds and Joint
    /// Replaces the expected sizes of the robot's errors by those they have, learn_sizes(); the
    /// groups held out are predicted with the same sizes. Needs Joint and a spread that is a prior.
    bool learns_sizes = false;
    /// Where there are doubts: campaigns that richer errors would make, to try. Nothing: none.
    std::function<std::vector<OtherCampaign>()> richer{};
    /// Ends the identification with the best so far; figures that are not complete are left out.
    StopSignal stop{};
    ProgressCallback progress{};  ///< of the identification, the groups held out and the sets
};

/// Each configuration by itself up to 100 of them, else ten groups; 0 of one.
Index default_folds(Index configuration_count);

/// What was measured.
struct MeasuredCount {
    Index configurations = 0;
    Index samples = 0;
    Index readings = 0;       ///< samples x targets that one shows at most
    Index readings_seen = 0;  ///< less those of targets that were not seen
};

/// RMS of the means that are no outliers: distances, m (angles, rad, where no length is measured),
/// and, where both are measured, angles, rad.
struct WithoutOutliers {
    double fit_rms = 0;
    std::optional<double> held_out_rms;
    std::optional<double> fit_angle_rms{};
    std::optional<double> held_out_angle_rms{};
};

/// A calibration: parameters, how sure they are, how accurate the robot is with them.
struct Calibration {
    /// As calibrated, with the model error found and sizes learned: names, units and scales of what
    /// follows.
    Campaign campaign;
    std::optional<ParameterSpread> stated_spread;  ///< where others were learned
    CalibrationMethod method = CalibrationMethod::Joint;
    MeasuredCount measured;             ///< that was calibrated with
    std::vector<std::string> excluded;  ///< CalibrationOptions::excluded
    std::vector<std::string> held;      ///< parameters that are as the earlier estimate has them
    /// Where some are held: standard deviations of the others (m, rad), were those held exact.
    std::map<std::string, double> sigmas_beside_held;
    /// Its ending says whether there is a calibration: where it is NotIdentifiable, nothing below
    /// but `selection` is filled in, and `undetermined` says why.
    Estimate estimate;
    Index starts = 0;                            ///< of Global
    Index starts_at_best = 0;                    ///< of Global; one alone: there may be better ones
    Metrics nominal;                             ///< base and targets fitted only, all samples
    RowMatrixXd nominal_residuals;               ///< of these, as residuals() has them
    std::optional<Repeatability> repeatability;  ///< nothing: no configuration was repeated
    std::optional<CrossValidation> held_out;
    /// Of means at poses like those measured; of samples over the workspace as estimated_geometry()
    /// draws it (nothing where it cannot, and for contacts).
    ExpectedError expected;
    std::optional<ExpectedError> expected_workspace;
    /// At CalibrationOptions::predicted: of distances, of angles.
    std::vector<ErrorPrediction> predicted;
    std::optional<double> limit;            ///< CalibrationOptions::limit
    std::optional<Judgement> verification;  ///< at CalibrationOptions::verification
    std::optional<Judgement> left_out;      ///< at the other configurations not used
    std::optional<Judgement> validation;    ///< at CalibrationOptions::validation
    /// Where poses to predict are unlike those calibrated with.
    std::optional<BeyondMeasured> predicted_beyond;
    /// With CalibrationOptions::refitted: the validation's campaign, which may have other targets,
    /// at the parameters that it was judged with.
    std::optional<Campaign> refitted;
    /// Standard deviations of them, m and rad; those of another campaign's count the robot's errors
    /// as exact.
    std::map<std::string, double> refitted_sigmas;
    /// By how much base and targets have moved up to the validation, where that is plain.
    std::optional<Moved> moved;
    /// The same since the earlier estimate, if that tells of both.
    std::optional<Moved> moved_since;
    std::optional<WithoutOutliers> without_outliers;  ///< if there are some
    std::optional<ModelSelection> selection;          ///< if asked for
    Doubts doubts;
    Cures cures;  ///< that were tried where there are doubts, of Joint
    /// What makes it none that may reach a robot: find_faults(), a calibrated robot that predicts
    /// others worse than the nominal one (or no better, with residuals far beyond those stated),
    /// that leaves more over than a robot misses before it is calibrated, or ten times more than
    /// without one configuration. Of Global, which expects large errors, values of any size are
    /// taken.
    std::vector<std::string> faults;

    bool is_identified() const { return estimate.ending != Ending::NotIdentifiable; }
};

/// Looks at the calibration by all that was measured before something is built on it.
using JudgeCalibration = std::function<void(const Calibration&)>;
/// Throws InputError, with what is wrong, if it has faults.
void refuse_faults(const Calibration& calibration);

/// What is wrong with CalibrationOptions::validation, not with what is calibrated with.
struct ValidationError : InputError {
    using InputError::InputError;
};

/// Finds base and targets from nothing, once, then identifies all parameters together and judges
/// them: on the samples, on configurations held out, on those not used, on the validation.
/// Throws InputError for measurements that do not fit the campaign (ValidationError for those of
/// the validation) and for options that contradict each other; measurements that do not identify
/// the model are a result.
Calibration calibrate(const Campaign& campaign, const Measurements& measurements,
                      const CalibrationOptions& options = {});

}  // namespace posewise
