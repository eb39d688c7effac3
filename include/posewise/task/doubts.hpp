#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/task/judgement.hpp"

/// Other ways in which measurements may have been meant: joints reversed, exchanged, coupled to a
/// neighbour, in another unit or from another zero; lengths in another unit; a left-handed
/// instrument; orientations in another sense. Each is tried by fitting base and targets of the
/// nominal robot.
namespace posewise {

/// RMS by which the nominal robot misses the means, with base and targets fitted.
struct ReadingMisfit {
    double distance_rms = 0;     ///< m; 0: no length is measured
    double orientation_rms = 0;  ///< angles, rad, or 1000 px; 0: none is measured
    const AmountUnits* orientation_units = &angle_units;

    /// Both in one, hypot(m, rad * 1 m).
    double size() const { return std::hypot(distance_rms, orientation_rms); }
    /// The latter for people: deg or px.
    double orientation_reading() const { return orientation_units->to_reading(orientation_rms); }
};

/// A way to read measurements, and how well they fit then.
struct TriedReading {
    std::string words;                  ///< "q2, q6 reversed"; "as stated"
    std::vector<std::string> reversed;  ///< joints
    bool is_of_directions = true;       ///< nothing but joint directions is changed
    ReadingMisfit misfit;
    /// Whether it fits as well as the first in the list, as for a symmetric robot.
    bool is_as_good_as_best = false;
};

/// A reading with which the measurements fit clearly better than as stated.
struct BetterReading {
    std::string words;                  ///< "j3 - j2 in place of j3"
    std::string cure;                   ///< "write j3 - j2 into the column j3"
    std::vector<std::string> reversed;  ///< joints
    Index change_count = 1;
    std::vector<std::string> as_well;  ///< others that fit exactly as well, in words
    ReadingMisfit misfit;
    ReadingMisfit as_stated;
};

struct ReadingSearch {
    std::vector<TriedReading> tried;  ///< the best fitting first
    std::string of;                   ///< what was read: "points"; of several sensors, of one
    std::optional<BetterReading> better;
    /// Why base and targets cannot be registered, as in Registration; then none was tried.
    std::string undetermined;
};

/// Tries all readings on 60 evenly spaced configurations. A better one misses by less than half as
/// much as the stated one, misses half of the points by less than ten expected errors of the robot,
/// and has no equally simple rival that fits nearly as well. Throws InputError as
/// register_base_and_targets() does.
ReadingSearch search_readings(const Campaign& campaign, const Measurements& measurements,
                              const ProgressCallback& progress = {});

/// "they fit clearly better with q2 reversed (1.97 instead of 666 mm RMS): write ...", for
/// messages.
std::string describe(const BetterReading& reading);

// Patterns in the residuals of a calibration that come from slips in measuring, not from robot
// errors and noise.

/// How far configurations are missed when each is predicted from the others (RMS of distances,
/// m; of angles, rad, where no length is measured): as they are, and after fitting a cure.
struct HeldOutChange {
    double before = 0;
    double after = 0;
};

/// Configurations that contradict the others.
struct OutlyingConfigurations {
    std::vector<std::string> ids;  ///< the worst first
    double squares_left = 1;       ///< share of the sum of squares that a fit without them leaves
    HeldOutChange held_out;        ///< without them
    /// Two of them that fit with each other's joint values.
    std::optional<std::pair<std::string, std::string>> exchanged;
};

/// A part of the set-up that was not in one place for all configurations.
struct SetUpChange {
    /// "base" (or the instrument), "target2", "tool", "socket s3", "readings of target2"
    std::string part;
    bool is_gradual = false;  ///< drifts from the first to the last, else one step
    std::string last_before;  ///< ids of the configurations before and after it
    std::string first_after;
    /// Motion of the second part of the configurations against the first, or over all of them.
    /// Base, sockets and readings: in the instrument's axes (the base at its origin); else in the
    /// flange's; m.
    Vector3d translation = Vector3d::Zero();
    Vector3d rotation = Vector3d::Zero();  ///< rad; 0 if that is within chance
    /// The smaller part, before or after, as leave_out() takes it: "21-40". Empty: leaving it out
    /// is no cure, and `held_out` is with the change as an additional unknown.
    std::string excluded;
    HeldOutChange held_out;
};

/// A common factor on all measured lengths, due to the instrument's scale or the robot's
/// temperature. Only the expected sizes of robot errors distinguish it from these.
struct LengthFactor {
    double excess = 0;     ///< factor - 1; above 0: the measured lengths are longer
    double deviation = 0;  ///< standard deviation of the excess
    /// If beyond chance: robot errors in their expected sizes (RMS), as they are and with readings
    /// scaled back.
    struct Errors {
        double before = 0;
        double after = 0;
    };
    std::optional<Errors> errors{};
};

/// Residuals that follow one joint.
struct JointPattern {
    enum class Kind {
        Scale,     ///< an error proportional to its value
        Backlash,  ///< an error with the sign of its last motion, in the order measured
    };
    std::string joint;
    Kind kind = Kind::Scale;
    double size = 0;  ///< Scale: a number; Backlash: from one side to the other, rad or m
    bool is_angle = true;
    HeldOutChange held_out;  ///< with it as an additional unknown
};

/// All joint angles are multiples of a step, which explains the residuals.
struct RoundedJoints {
    double step = 0;         ///< rad
    double effect = 0;       ///< RMS on distances by rounding alone (m; rad without lengths)
    HeldOutChange held_out;  ///< with the rounding stated as the joints' repeatability
};

/// All lengths read are multiples of a step, which explains the residuals.
struct RoundedReadings {
    double step = 0;    ///< m
    double effect = 0;  ///< RMS on distances by rounding alone (m)
    double left = 0;    ///< RMS residual of the fit (m)
};

/// Rows of the file with the joint values of others.
struct ShiftedRows {
    std::string first;  ///< configuration where they begin
    Index shift = 0;    ///< its own joint values are this many rows before (below 0: after)
    double before = 0;  ///< median error of the nominal robot, m or rad
    double after = 0;   ///< likewise with rows set right
};

/// Findings in residuals. By chance each of them is found in fewer than 1 of 1000 campaigns, the
/// factor of lengths in fewer than 3 of 1000.
struct ResidualLook {
    std::optional<OutlyingConfigurations> outlying;
    std::vector<SetUpChange> changes;
    std::optional<LengthFactor> lengths;  ///< whenever lengths determine one
    std::vector<JointPattern> joints;
    std::optional<RoundedJoints> rounded;
    std::optional<RoundedReadings> rounded_readings;
    std::optional<ShiftedRows> shifted;

    bool is_empty() const;
};

/// Looks for patterns in the residuals of `estimate`, identified from these measurements of the
/// campaign. Finds nothing if it is not determined, or with fewer than eight configurations. Cures
/// are fitted only where something is found.
ResidualLook look_at_residuals(const Campaign& campaign, const Measurements& measurements,
                               const Estimate& estimate);

/// Configurations that a robust fit calls outliers (at most a fifth of all, and ten), if without
/// them at most a tenth of the RMS is left. For measurements that the nominal robot misses grossly:
/// such large errors hide single configurations from look_at_residuals().
std::optional<OutlyingConfigurations> find_gross_configurations(const Campaign& campaign,
                                                                const Measurements& measurements,
                                                                const Estimate& estimate);

/// Rows, from some row on, with the joint values of the row before or after, if setting them right
/// reduces the nominal robot's median error to less than a fifth. For measurements that it misses
/// grossly.
std::optional<ShiftedRows> find_shifted_rows(const Campaign& campaign,
                                             const Measurements& measurements);

// Doubts about measurements and about what was identified from them. A doubt stops nothing; it says
// what to look at first.

/// Configurations beyond the campaign's joint limits. They are used nevertheless: they were
/// measured there.
struct BeyondLimits {
    Index count = 0;
    Index first = 0;  ///< index of the first one
    /// The first such joint of that configuration: "q2 is 61 deg, must be from -50 to 60 deg".
    std::string violation;
};
std::optional<BeyondLimits> find_beyond_limits(const Campaign& campaign,
                                               const RowMatrixXd& configurations);

/// Joints that have one value in all of several configurations.
std::vector<Index> find_still_joints(const Campaign& campaign, const RowMatrixXd& configurations);

/// Configurations in which joints leave their measured range by more than a tenth of it: what is
/// expected there is an extrapolation.
struct BeyondMeasured {
    Index count = 0;                  ///< configurations that do
    Index of = 0;                     ///< all configurations
    std::vector<std::string> joints;  ///< joints that leave it in some of them
};
/// Nothing if none does.
std::optional<BeyondMeasured> find_beyond_measured(const Campaign& campaign,
                                                   const RowMatrixXd& measured,
                                                   const RowMatrixXd& configurations);

/// A plane measured with a reversed normal, with a normal turned by at least 45 deg or, if planes
/// are known, with the other sign of the offset; planes are fitted with base and robot as stated.
struct PlaneDoubt {
    Index plane = 0;
    Plane stated;
    Plane measured;
};
std::vector<PlaneDoubt> find_plane_doubts(const Campaign& campaign,
                                          const Measurements& measurements);

/// Base or a target that was measured elsewhere than the campaign states.
struct PlaceDoubt {
    std::string name;  ///< like that of its parameters: "base", "target1", "tool"
    Vector3d stated;   ///< m; base: in the instrument's frame, target: in the flange's
    Vector3d found;
    /// The unit in which the stated number would be right, if m and mm were confused.
    enum class Unit { AsRead, Metres, Millimetres } unit = Unit::AsRead;
    /// The target that is stated where this one was found, if they seem exchanged; else empty.
    std::string exchanged_with = {};
    /// How far the base is turned from the stated one, rad, if by more than 20 deg; else 0.
    double turn = 0;
};
/// Places that are off by a factor of about 1000, by more than 100 mm, or exchanged, and a base
/// turned by more than 20 deg. `registered` is as for find_misfit(). What is known, or was not
/// stated, is not checked.
std::vector<PlaceDoubt> find_place_doubts(const Campaign& campaign, const Parameters& registered);

/// Intrinsic parameters that fit far better than those that are stated as known.
struct OtherImage {
    std::string words;    ///< which image these are of: "an image 2 times as large"
    double distance = 0;  ///< by which the nominal robot then misses half of the corners, 1000 px
};

/// The nominal robot explains its own measurements to about its expected error, but not those of
/// another robot.
struct Misfit {
    double distance = 0;  ///< it misses half of them by at least this, base and targets fitted, m
    double expected = 0;  ///< by the spread, m
    std::vector<PlaneDoubt> planes;
    std::optional<BetterReading> reading;  ///< for joints, lengths or orientations
    /// The camera at fault, from 0, where one of several is: by itself it is missed by `distance`.
    std::optional<Index> camera{};
    bool is_between_cameras = false;  ///< each by itself is missed far less
    double others = 0;                ///< by which the other cameras, or each by itself, are missed
    std::optional<OtherImage> image{};  ///< if the intrinsics look like those of another image
    /// By which half of the corners are missed if the camera is on the flange and not fixed, or the
    /// other way round: where that is far less.
    std::optional<double> on_other_side{};

    /// Whether something else that was tried fits far better.
    bool is_explained() const {
        return reading || image || camera || is_between_cameras || on_other_side;
    }
};

/// Nothing if the nominal robot explains the measurements, or misses them by less than ten expected
/// errors and no other reading fits clearly better. `registered` is register_base_and_targets() of
/// these measurements.
std::optional<Misfit> find_misfit(const Campaign& campaign, const Measurements& measurements,
                                  const Parameters& registered);

/// Throws InputError, with describe_misfit() or describe_places(), for a misfit or a place in
/// another unit. Measurements that do not determine base and targets pass: they are too few to
/// judge.
void check_is_of_robot(const Campaign& campaign, const Measurements& measurements,
                       const Registration& registration);

/// One sentence for messages: how far the nominal robot misses the measurements, and which planes
/// may be wrong or how else they may have been meant.
std::string describe_misfit(const Campaign& campaign, const Misfit& misfit);
/// "plane 2 looks reversed: stated with ..."; empty for none.
std::string describe_planes(const std::vector<PlaneDoubt>& planes);
/// "the base is stated at [...] mm, measured at [...] mm ..."; empty for none.
std::string describe_places(const std::vector<PlaceDoubt>& places);

/// A robot error far above its expected size.
struct SizeDoubt {
    std::string parameter;
    double times = 0;  ///< multiple of the expected size
    double value = 0;  ///< in SI units, or as its units have it
    const AmountUnits* units = &length_units;
    bool is_term = false;  ///< depends on the configuration: no nominal value contains it
};

/// A model error found that exceeds the expected one by more than two standard deviations.
struct ModelErrorDoubt {
    double times = 0;  ///< multiple of the expected one
    double value = 0;  ///< m or rad
    bool is_angle = false;
    bool is_limit = false;  ///< the largest that is looked for: it may be larger
};

/// Residuals that clearly differ from those stated: all, or separately lengths and angles.
struct ResidualDoubt {
    double ratio = 1;  ///< found / stated
    bool is_angle = false;
    /// The model error (m or rad) that would fit them; 0 if none is that small.
    double fitting = 0;
};

/// Repeated samples that differ far more than the instrument's stated noise.
struct ScatterDoubt {
    double ratio = 1;    ///< standard deviation about the means, found / stated
    std::string sample;  ///< the farthest, for leave_out(): "7:2"
};
/// Nothing if no configuration was repeated, or if the ratio is less than three.
std::optional<ScatterDoubt> find_scatter_doubt(const Campaign& campaign,
                                               const Measurements& measurements,
                                               const Parameters& parameters);

/// A distance between two sockets that the measurements contradict.
struct DistanceDoubt {
    std::string socket;
    std::string from;
    double stated = 0;  ///< m
    double found = 0;   ///< with the distance unknown, too, m
};
/// The distance without which most is explained, if residuals are far above what is stated and less
/// than half of them are left then.
std::optional<DistanceDoubt> find_distance_doubt(const Campaign& campaign,
                                                 const Measurements& measurements,
                                                 const Estimate& estimate);

/// A view of a board that contradicts the other views.
struct ViewDoubt {
    std::string sample;  ///< configuration, or one of its samples, as leave_out() takes it
    Index camera = 0;    ///< from 0
    /// Its corners fit no pose of the board; else one, but not that which the joints say.
    bool is_no_board = false;
    double distance = 0;  ///< by which its corners are off either, RMS of u and v, 1000 px
    double others = 0;    ///< likewise, the median view
    /// If they fit where the joints say once they are numbered so: "in mirrored order".
    std::string order;
};
/// Finds them where fewer than half of the views are such, of a camera with exact corners;
/// `registered` is as for find_misfit().
std::vector<ViewDoubt> find_view_doubts(const Campaign& campaign, const Measurements& measurements,
                                        const Parameters& registered);

/// What looks wrong of a camera's board or its intrinsic parameters.
struct CameraDoubt {
    Index sensor = 0;  ///< which of several sees so, from 1; 0: it is the only one
    /// A calibration says that the board is so many times as large; 1: nothing is wrong.
    double board_factor = 1;
    double square = 0;         ///< side of a chessboard's squares as stated, m; 0: it is none
    double misfit = 0;         ///< RMS of what is left at the corners, 1000 px
    double scaled_misfit = 0;  ///< with that factor
    Index camera = 0;          ///< whose principal point it is, from 0
    /// Principal point, if it is far from the middle of the image (or of what is seen), px.
    std::optional<std::array<double, 2>> principal_point{};
    std::array<double, 2> middle{};
    bool is_of_image = false;  ///< whose size is stated; else the middle of what is seen
    /// Focal lengths found, px, if one is negative, or half as long again as those stated.
    std::optional<std::array<double, 2>> focal_lengths{};
    std::optional<std::array<double, 2>> stated_focal_lengths{};  ///< in the second case
    /// Most views show a plane board from behind its stated front.
    bool is_seen_from_back = false;
    /// Standard deviation of u and of v about any pose of the board, px, if it is another one than
    /// the sensor's; else 0.
    double scatter = 0;
    double sigma = 0;  ///< as stated, px
};
/// Of corners in images, of several sensors of the first that has one, a board of another size
/// before all else; `registered` is as for find_misfit().
std::optional<CameraDoubt> find_camera_doubt(const Campaign& campaign,
                                             const Measurements& measurements,
                                             const Parameters& registered);

/// Whether the overall scale depends only on the robot's lengths, which are identified: there are
/// sockets without a known distance, or planes without a known offset that were touched (readings
/// within 1 mm of 0).
bool lacks_length(const Campaign& campaign, const Measurements& measurements);

/// RMS errors, m (rad where no length is measured).
struct WorkspaceDoubt {
    double expected = 0;  ///< over the workspace, with the calibrated robot
    double nominal = 0;   ///< at the poses measured, with the nominal robot
};

/// All doubts about a calibration.
struct Doubts {
    std::optional<Misfit> misfit;
    std::vector<PlaneDoubt> planes;  ///< if there is no misfit, which has its own
    std::vector<PlaceDoubt> places;  ///< if there is no misfit
    /// RMS distance (m) by which the nominal robot misses the points, if gross: outliers?
    std::optional<double> gross_error;
    /// Likewise for orientations (RMS, rad).
    std::optional<double> orientations;
    std::vector<SizeDoubt> sizes;
    std::vector<SizeDoubt> learned_sizes;       ///< one for each class, "spread.harmonic"
    std::vector<ModelErrorDoubt> model_errors;  ///< for lengths, for angles
    /// Approximate share, 0 to 1, of the remaining squares that follows bending and periodic
    /// errors of joints missing in the model; if that is clear, and more than a twentieth.
    std::optional<double> missing_errors;
    std::optional<ScatterDoubt> scatter;
    bool lacks_length = false;  ///< see lacks_length()
    std::optional<DistanceDoubt> distance;
    std::vector<ViewDoubt> views;  ///< all others but `look` are of the rest
    std::optional<CameraDoubt> camera;
    /// If the calibrated robot is not shown to predict held-out poses better than the nominal one.
    std::optional<HeldOutComparison> held_out;
    /// Residuals more than 1.2 times larger or smaller than stated, and in the 0.1 % tails of chi
    /// squared with these degrees of freedom.
    std::vector<ResidualDoubt> residuals;
    /// Found / stated over all residuals, if below a fiftieth: sigma or model error is stated in
    /// another unit. If the stated model error is above 5 mm, the ratio includes that of the model
    /// error.
    std::optional<double> small_residuals;
    /// Joints whose compliance is clearly negative, by three standard deviations.
    std::vector<Index> negative_compliances;
    ResidualLook look;
    /// If a calibration with few poses is expected to miss the workspace by more than twice what
    /// the nominal robot misses.
    std::optional<WorkspaceDoubt> workspace;
};

/// Whether implausible values are faults.
enum class ValueCheck { ByExpectedSizes, None };

/// Why an estimate of this campaign must not reach a robot, in words: it did not converge;
/// residuals (of lengths or angles) are hundreds of times the noise and model error stated; a plane
/// is turned from its stated normal; a value is fifty times, or a standard deviation a hundred
/// times, its expected size; the offset of a joint is beyond 10 deg and five times its expected
/// size. Or values are absurd: a model error beyond 100 mm or 100 mrad, a base 1 km from the
/// instrument, a target 10 m from the flange or within 1 mm of another, a variance below what
/// rounding leaves. Empty: nothing.
std::vector<std::string> find_faults(const Campaign& campaign, const Estimate& estimate,
                                     ValueCheck values = ValueCheck::ByExpectedSizes);

/// Doubts about measurements. `registered` is as for find_misfit(), `nominal` are its metrics.
Doubts find_doubts(const Campaign& campaign, const Measurements& measurements,
                   const Parameters& registered, const Metrics& nominal);
/// Adds doubts about what was identified from them.
void add_doubts(const Campaign& campaign, const Measurements& measurements,
                const Estimate& estimate, Doubts& doubts);

}  // namespace posewise
