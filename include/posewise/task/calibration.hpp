#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/task/answers.hpp"
#include "posewise/task/doubts.hpp"
#include "posewise/task/judgement.hpp"

namespace posewise {

/// How much a robot's errors may have changed since its calibration, as standard deviations.
struct Drift {
    double length = 2e-5;  ///< m
    double offset = 1e-4;  ///< for a revolute joint's offset (rad)
    double angle = 2e-5;   ///< for all other angles (rad)
};

/// How an earlier estimate is used.
struct EarlierUse {
    bool is_prior = false;  ///< the prior is its covariance, plus drift of the robot's errors
    Drift drift{};
    bool has_new_base = false;     ///< the base has moved: the estimate does not cover it
    bool has_new_targets = false;  ///< so have the targets (the sensor's unknowns)
    /// What is still to be identified: "base", "targets" (the sensor's unknowns), "robot" or
    /// names of its errors; everything else is known to be as it was. Empty: all.
    std::vector<std::string> only{};
};

/// An earlier estimate of the same robot.
struct Earlier {
    Estimate estimate;  ///< with the campaign's parameter names
    EarlierUse use{};
};

/// The campaign as an earlier estimate describes it, to select, plan, study and identify with.
/// Base, targets and robot errors are expected where it found them; what has moved since is as the
/// campaign states it. The model error and the sizes of errors are as found. What shall not be
/// identified is no parameter any more. EarlierUse::is_prior makes the estimate the prior. Throws
/// InputError for unknown names in EarlierUse::only, if they leave nothing to identify, for an
/// estimate of other parameters, and if its base is not where the campaign states it as known,
/// unless that has moved.
Campaign with_earlier(const Campaign& campaign, const Earlier& earlier);

/// Converts a robot's errors to the same robot with other loads: compliances are given at the
/// largest torque that occurs. Throws InputError for a robot with other errors.
VectorXd errors_under_loads(const Chain& robot, const VectorXd& errors, const Chain& loaded);

/// How parameters are identified.
enum class CalibrationMethod {
    Joint,    ///< all together, identify()
    TwoStep,  ///< identify_two_step(): to compare with the literature
    Global,   ///< identify_globally(): for a robot that is far from nominal
};
/// "lm", "two-step", "global".
std::string_view method_name(CalibrationMethod method);

struct CalibrationOptions {
    CalibrationMethod method = CalibrationMethod::Joint;
    /// For the joint identification; its loss also for the nominal fit and for what is held out.
    /// Other methods only know squares.
    LevenbergMarquardtOptions joint{};
    TwoStepOptions two_step{};
    GlobalOptions global{};
    /// Configurations to calibrate with, such as those of a plan; the calibration is judged on the
    /// others, too. Empty: all.
    std::vector<Index> used{};
    /// Configurations that are not used but judged separately, such as a plan's verification poses.
    /// None may be in `used`, which must be stated.
    std::vector<Index> verification{};
    /// What was noted beside the measurements, to look for in the residuals.
    std::vector<Condition> conditions{};
    /// What leave_out() removed from the measurements by hand, for the record.
    std::vector<std::string> excluded{};
    /// An earlier estimate; needs Joint.
    std::optional<Earlier> earlier{};
    /// More measurements, only to judge on; the caller keeps them alive. Null: none.
    const Measurements* validation = nullptr;
    /// What is identified anew for them, because they were measured with another set-up: "base",
    /// "targets" or both. The rest stays. Empty: nothing.
    std::vector<std::string> refitted{};
    /// Their campaign: the same robot, perhaps with another payload, and the same errors, but other
    /// targets or another sensor. Then base and targets must both be refitted. Null: the same
    /// campaign.
    const Campaign* validation_campaign = nullptr;
    /// Limit for the RMS of distances where the calibration is judged (judge_limit()), m.
    std::optional<double> limit{};
    /// Configurations, measured or not, for which to predict the error (m x joints, and measured
    /// torques; rad, m, N m). Empty: none.
    RowMatrixXd predicted{};
    /// Groups of configurations to hold out in turn; 0: none. Nothing: default_folds().
    std::optional<Index> folds{};
    bool model_selection = false;  ///< also compares nested parameter sets; needs folds and Joint
    /// Called if there are doubts: campaigns with richer errors to try. Nothing: none.
    std::function<std::vector<OtherCampaign>()> richer{};
    /// Ends the identification with the best result so far; incomplete figures are left out.
    StopSignal stop{};
    ProgressCallback progress{};  ///< counts the identification, the groups held out and the sets
};

/// One group per configuration up to 100 of them, else ten groups; 0 for one configuration.
Index default_folds(Index configuration_count);

/// What was measured.
struct MeasuredCount {
    Index configurations = 0;
    Index samples = 0;
    Index readings = 0;       ///< samples x targets that one shows at most
    Index readings_seen = 0;  ///< without those of targets that were not seen
};

/// RMS of the means that are no outliers: of distances, m (of angles, rad, where no length is
/// measured), and also of angles where both are measured.
struct WithoutOutliers {
    double fit_rms = 0;
    std::optional<double> held_out_rms;
    std::optional<double> fit_angle_rms{};
    std::optional<double> held_out_angle_rms{};
};

/// What one of several instruments is missed by, in its own unit.
struct SensorAccuracy {
    std::string readings;                      ///< "points", "corners"
    const AmountUnits* units = &length_units;  ///< of Metrics::rms()
    Metrics nominal, fit;                      ///< all samples
    std::optional<Metrics> held_out{};
};

/// A calibration: parameters, their uncertainty, and the robot's accuracy with them.
struct Calibration {
    /// As calibrated, with the model error found and sizes learned: names, units and scales of
    /// everything below.
    Campaign campaign;
    std::optional<ParameterSpread> stated_spread;  ///< if others were learned
    CalibrationMethod method = CalibrationMethod::Joint;
    MeasuredCount measured;             ///< what was calibrated with
    std::vector<std::string> excluded;  ///< CalibrationOptions::excluded
    std::vector<std::string> held;      ///< parameters kept from the earlier estimate
    /// If some are held: standard deviations of the others (m, rad), as if the held ones were
    /// exact.
    std::map<std::string, double> sigmas_beside_held;
    /// Its ending says whether there is a calibration. If it is NotIdentifiable, nothing below but
    /// `selection` is filled in, and `undetermined` says why.
    Estimate estimate;
    Index starts = 0;                            ///< for Global
    Index starts_at_best = 0;                    ///< for Global; only one: there may be better ones
    Metrics nominal;                             ///< only base and targets fitted, all samples
    RowMatrixXd nominal_residuals;               ///< like residuals(), for the same fit
    std::vector<SensorAccuracy> by_sensor;       ///< of a CombinedSensor each, else empty
    std::optional<Repeatability> repeatability;  ///< nothing: no configuration was repeated
    std::optional<CrossValidation> held_out;
    std::optional<RmsInterval> held_out_interval;  ///< 95 %, of the samples' RMS
    /// The nominal robot at the same poses; only where the fit has converged.
    std::optional<HeldOutComparison> held_out_comparison;
    std::optional<Influence> influence;     ///< the pose that matters most
    std::optional<OrderTrend> order_trend;  ///< whether residuals drift
    /// Whether they follow CalibrationOptions::conditions; of four configurations at least.
    std::vector<ConditionTrend> condition_trends{};
    /// For means at poses like the measured ones; for samples over the workspace that
    /// estimated_geometry() draws (nothing where it cannot, and for contacts).
    ExpectedError expected;
    std::optional<ExpectedError> expected_workspace;
    /// Over the same workspace, of the place in space of what a camera sees, m.
    std::optional<ExpectedError> expected_place{};
    std::optional<RobotError> expected_robot{};
    /// At CalibrationOptions::predicted: for distances, for angles.
    std::vector<ErrorPrediction> predicted;
    std::vector<ImageCoverage> images{};    ///< find_image_coverage(), one a camera
    std::optional<double> limit;            ///< CalibrationOptions::limit
    std::optional<Judgement> verification;  ///< at CalibrationOptions::verification
    std::optional<Judgement> left_out;      ///< at the other configurations not used
    std::optional<Judgement> validation;    ///< at CalibrationOptions::validation
    /// If poses to predict are unlike those calibrated with.
    std::optional<BeyondMeasured> predicted_beyond;
    /// With CalibrationOptions::refitted: the validation's campaign, perhaps with other targets, at
    /// the parameters it was judged with.
    std::optional<Campaign> refitted;
    /// Standard deviations of these, m and rad; for another campaign they take the robot's errors
    /// as exact.
    std::map<std::string, double> refitted_sigmas;
    /// How far base and targets have moved up to the validation, if that is plain.
    std::optional<Moved> moved;
    /// Likewise since the earlier estimate, if it covers both.
    std::optional<Moved> moved_since;
    std::optional<WithoutOutliers> without_outliers;  ///< if there are some
    std::optional<ModelSelection> selection;          ///< if asked for
    Doubts doubts;
    Cures cures;  ///< tried where there are doubts, for Joint
    /// Why the calibration must not reach a robot: find_faults(); it predicts held-out poses worse
    /// than the nominal robot (or no better, with residuals far beyond those stated); it leaves
    /// more over than a robot misses before it is calibrated, or ten times more than without one
    /// configuration; all lengths are off by over 0.5 %. Global expects large errors and takes
    /// values of any size.
    std::vector<std::string> faults;

    bool is_identified() const { return estimate.ending != Ending::NotIdentifiable; }
};

/// Judges the calibration with all that was measured, before anything is built on it.
using JudgeCalibration = std::function<void(const Calibration&)>;
/// Throws InputError, with what is wrong, if it has faults.
void refuse_faults(const Calibration& calibration);

/// An error in CalibrationOptions::validation, not in what is calibrated with.
struct ValidationError : InputError {
    using InputError::InputError;
};

/// Finds base and targets from nothing, once, then identifies all parameters together and judges
/// them: on the samples, on configurations held out, on those not used, on the validation. Throws
/// InputError for measurements that do not fit the campaign (ValidationError for those of the
/// validation) and for options that contradict each other; measurements that do not identify the
/// model are a result.
Calibration calibrate(const Campaign& campaign, const Measurements& measurements,
                      const CalibrationOptions& options = {});

// Hand-eye: where camera and board are.

/// Where a frame was found in another one, and how sure that is.
struct FoundPlace {
    Isometry3d place = Isometry3d::Identity();
    /// Of a small motion of the frame: its origin's place (m), then its rotation vector (rad),
    /// along the axes of the frame that it is in.
    Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};
/// Standard deviations (6) along the axes of the frame that it is in, or along its own.
VectorXd deviations_of(const FoundPlace& found, bool is_along_own);
/// Half axes, in columns, of the ellipsoid that has the frame's origin with 95 % (all three
/// coordinates together, chi-squared), shortest first; m, along the axes of the frame that it is
/// in.
Matrix3d ellipsoid_of(const FoundPlace& found);

struct HandEye {
    bool is_camera_on_flange = false;  ///< else the board is
    /// In the flange frame; nothing: it is known.
    std::optional<FoundPlace> on_flange{};
    /// The other one in the base frame; nothing: it is known.
    std::optional<FoundPlace> at_base{};
};
/// By the estimate and its covariance, base and sensor jointly with the robot's errors. Nothing:
/// the sensor measures neither corners in an image nor, from the flange, poses of a board.
std::optional<HandEye> find_hand_eye(const Campaign& campaign, const Estimate& estimate);

// Residuals of each reading, to look for what a calibration does not explain.

/// Where a target is, seen from the instrument.
struct Direction {
    double range = 0;      ///< m
    double azimuth = 0;    ///< atan2(y, x) in the instrument's axes, which are the world's, rad
    double elevation = 0;  ///< above the xy plane, rad
};

/// One sample of one target. Each vector has Sensor::rows_per_target() numbers, m or rad: observed
/// minus predicted.
struct ReadingResidual {
    Index configuration = 0;
    Index sample = 0;  ///< row of Measurements::observations
    Index target = 0;
    VectorXd calibrated;
    VectorXd nominal;                  ///< by the robot that is not calibrated
    std::optional<VectorXd> held_out;  ///< predicted without its configuration
    VectorXd standardised;             ///< calibrated, divided by its expected standard deviation
    std::optional<Direction> direction;
};

/// The residuals of a calibration that was made with these measurements, in their order.
std::vector<ReadingResidual> list_residuals(const Calibration& calibration,
                                            const Measurements& measurements);

/// How a stored estimate is judged again.
struct ResidualOptions {
    Loss loss{};      ///< the loss it was made with
    Index folds = 0;  ///< groups held out; 0: none
};
/// As above for an estimate of the campaign, which has its model error: nominal and held-out
/// residuals are fitted again. Throws InputError as calibrate() does.
std::vector<ReadingResidual> list_residuals(const Campaign& campaign, const Estimate& estimate,
                                            const Measurements& measurements,
                                            const ResidualOptions& options = {});

/// Residuals of measurements that the calibration was not made with: only configuration, sample,
/// target and `calibrated` are filled in.
std::vector<ReadingResidual> list_residuals(const Campaign& campaign, const Parameters& parameters,
                                            const Measurements& measurements);

/// A camera, and which targets are corners in its image.
struct CameraImage {
    Index camera = 0;               ///< of its sensor, from 0
    std::optional<Index> sensor{};  ///< of several, from 0: the first with this camera
    std::optional<std::array<double, 2>> size{};   ///< width and height, px
    std::vector<std::pair<Index, Index>> targets;  ///< first and count, of each board
    /// "camera 2", "sensor 2" or "camera 2 of sensor 3"; empty: there is one camera only.
    std::string name{};
};
/// The cameras of a sensor or of several; empty: there are none.
std::vector<CameraImage> camera_images(const Sensor& sensor);

/// Which parts of its image each camera has seen corners in, all samples; only of cameras whose
/// image has a stated size.
std::vector<ImageCoverage> find_image_coverage(const Sensor& sensor,
                                               const Measurements& measurements);

/// Names of a residual's numbers: "x", "y", "z", "rx", ...; "distance" for readings that are one
/// length.
std::vector<std::string> residual_axes(const Campaign& campaign);

}  // namespace posewise
