#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/calibrator/identification.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/task/held_out.hpp"
#include "posewise/task/readings.hpp"
#include "posewise/task/residual_look.hpp"

/// What looks wrong with measurements and what was identified from them. A doubt stops nothing; it
/// is what to look at first.
namespace posewise {

/// Configurations beyond the campaign's joint limits; they are taken all the same: measured ones
/// were there.
struct BeyondLimits {
    Index count = 0;
    Index first = 0;        ///< the first of them
    std::string violation;  ///< its first joint: "q2 is 61 deg, must be from -50 to 60 deg"
};
std::optional<BeyondLimits> find_beyond_limits(const Campaign& campaign,
                                               const RowMatrixXd& configurations);

/// Joints that have the same value in all of several configurations.
std::vector<Index> find_still_joints(const Campaign& campaign, const RowMatrixXd& configurations);

/// Configurations in which joints leave the range of those measured, by over a tenth of it: what is
/// expected there is an extrapolation.
struct BeyondMeasured {
    Index count = 0;                  ///< of configurations
    Index of = 0;                     ///< so many
    std::vector<std::string> joints;  ///< that leave it in some of them
};
/// Nothing where none does.
std::optional<BeyondMeasured> find_beyond_measured(const Campaign& campaign,
                                                   const RowMatrixXd& measured,
                                                   const RowMatrixXd& configurations);

/// A plane whose normal is measured reversed or turned by 45 deg and more or, where planes are
/// known, whose offset is measured with the other sign: of planes fitted to base and robot as
/// stated.
struct PlaneDoubt {
    Index plane = 0;
    Plane stated;
    Plane measured;
};
std::vector<PlaneDoubt> find_plane_doubts(const Campaign& campaign,
                                          const Measurements& measurements);

/// Base or a target that the measurements put elsewhere than the campaign states it.
struct PlaceDoubt {
    std::string name;  ///< as that of its parameters: "base", "target1", "tool"
    Vector3d stated;   ///< m; of the base in the instrument's frame, of a target in the flange's
    Vector3d found;
    /// What the number stated would be right in, had it been read in the other one of m and mm.
    enum class Unit { AsRead, Metres, Millimetres } unit = Unit::AsRead;
    /// The target that is stated where this one was found, if they look exchanged; else empty.
    std::string exchanged_with = {};
    /// By how much the base is turned from how it is stated, rad, if by more than 20 deg; else 0.
    double turn = 0;
};
/// Those off by a factor of about 1000, by more than 100 mm, or exchanged, and a base turned by
/// more than 20 deg. `registered` as for find_misfit(); what is known, or was not stated, is not
/// looked at.
std::vector<PlaceDoubt> find_place_doubts(const Campaign& campaign, const Parameters& registered);

/// The nominal robot explains its own measurements to about the error expected of it, another
/// robot's not.
struct Misfit {
    double distance = 0;  ///< by which it misses half of them at least, base and targets fitted, m
    double expected = 0;  ///< as the spread says, m
    std::vector<PlaneDoubt> planes;
    std::optional<BetterReading> reading;  ///< of joints, lengths or orientations
};

/// Nothing if the nominal robot explains the measurements, or misses them by less than ten expected
/// errors and no other reading fits clearly better. `registered`: base and targets, by
/// register_base_and_targets() of these measurements.
std::optional<Misfit> find_misfit(const Campaign& campaign, const Measurements& measurements,
                                  const Parameters& registered);

/// Throws InputError, with describe_misfit() or describe_places(), if there is a misfit or a place
/// in another unit; measurements that do not determine base and targets are too few to tell.
void check_is_of_robot(const Campaign& campaign, const Measurements& measurements,
                       const Registration& registration);

/// One sentence, for messages: by how much the nominal robot misses the measurements, and which
/// planes may be wrong or how else they may have been meant.
std::string describe_misfit(const Campaign& campaign, const Misfit& misfit);
/// "plane 2 looks reversed: stated with ..."; empty for none.
std::string describe_planes(const std::vector<PlaneDoubt>& planes);
/// "the base is stated at [...] mm, measured at [...] mm ..."; empty for none.
std::string describe_places(const std::vector<PlaceDoubt>& places);

/// An error of the robot far above its expected size.
struct SizeDoubt {
    std::string parameter;
    double times = 0;  ///< the expected size
    double value = 0;  ///< m or rad
    bool is_angle = false;
    bool is_term = false;  ///< depends on the configuration: no nominal value has it
};

/// A model error found that is larger than two standard deviations of what is expected.
struct ModelErrorDoubt {
    double times = 0;  ///< the expected one
    double value = 0;  ///< m or rad
    bool is_angle = false;
};

/// Residuals that are clearly not as stated: of all, or of lengths and angles apart.
struct ResidualDoubt {
    double ratio = 1;  ///< in units of those stated
    bool is_angle = false;
    /// The model error (m or rad) that they would fit; 0 where none is that small.
    double fitting = 0;
};

/// Repeated samples that differ by far more than the instrument's noise as stated.
struct ScatterDoubt {
    double ratio = 1;    ///< standard deviation about the means, in units of that stated
    std::string sample;  ///< the farthest, as leave_out() takes it: "7:2"
};
/// Nothing where no configuration was repeated, or they scatter by less than three times.
std::optional<ScatterDoubt> find_scatter_doubt(const Campaign& campaign,
                                               const Measurements& measurements,
                                               const Parameters& parameters);

/// A distance of two sockets that the measurements contradict.
struct DistanceDoubt {
    std::string socket;
    std::string from;
    double stated = 0;  ///< m
    double found = 0;   ///< where it is unknown, too, m
};
/// The one that most is explained without, if residuals are far above what is stated and less than
/// half of them are left then.
std::optional<DistanceDoubt> find_distance_doubt(const Campaign& campaign,
                                                 const Measurements& measurements,
                                                 const Estimate& estimate);

/// Whether nothing but the robot's lengths, which are identified, says how large all is: sockets
/// without a distance known, or planes none of whose offsets is, which were touched (readings
/// within 1 mm of 0).
bool lacks_length(const Campaign& campaign, const Measurements& measurements);

/// All doubts about a calibration.
struct Doubts {
    std::optional<Misfit> misfit;
    std::vector<PlaneDoubt> planes;  ///< where there is no misfit, which has its own
    std::vector<PlaceDoubt> places;  ///< where there is no misfit
    /// Distance by which the nominal robot misses the points (RMS, m), if grossly: outliers?
    std::optional<double> gross_error;
    /// The same of orientations (RMS, rad).
    std::optional<double> orientations;
    std::vector<SizeDoubt> sizes;
    std::vector<ModelErrorDoubt> model_errors;  ///< of lengths, of angles
    /// About how much of the squares left over follows bending and periodic errors of joints that
    /// the model has not, 0 to 1; if that is clear, and more than a twentieth.
    std::optional<double> missing_errors;
    std::optional<ScatterDoubt> scatter;
    bool lacks_length = false;  ///< see lacks_length()
    std::optional<DistanceDoubt> distance;
    std::optional<HeldBackSize> held_back;  ///< where sizes were learned
    /// Where the calibrated robot is not shown to predict others better than the nominal one.
    std::optional<HeldOutComparison> held_out;
    /// Those that are more than 1.2 times larger or smaller than stated, and beyond what chi
    /// squared of the degrees of freedom is once in a thousand times.
    std::vector<ResidualDoubt> residuals;
    /// Of all residuals where they are below a fiftieth: sigma or model error is stated in another
    /// unit. A model error that was found counts as it was stated, where that is above 5 mm.
    std::optional<double> small_residuals;
    /// Joints whose compliance is clearly negative: by three standard deviations.
    std::vector<Index> negative_compliances;
    ResidualLook look;
};

/// How large values may be to be believed.
enum class ValueCheck { ByExpectedSizes, None };

/// What is so wrong with an estimate of this campaign that it must not reach a robot, in words:
/// that it did not converge, residuals (of lengths or of angles) of hundreds of times the noise and
/// model error stated, a value of fifty times its expected size or a standard deviation of a
/// hundred, the offset of a joint beyond 10 deg and five times its expected size, or what no cell
/// has: a model error beyond 100 mm or 100 mrad, a base 1 km from the instrument, a target 10 m
/// from the flange or within 1 mm of another, a variance below what rounding leaves. Empty:
/// nothing.
std::vector<std::string> find_faults(const Campaign& campaign, const Estimate& estimate,
                                     ValueCheck values = ValueCheck::ByExpectedSizes);

/// Doubts about measurements: `registered` as for find_misfit(), `nominal` its metrics.
Doubts find_doubts(const Campaign& campaign, const Measurements& measurements,
                   const Parameters& registered, const Metrics& nominal);
/// Adds those about what was identified from them.
void add_doubts(const Campaign& campaign, const Measurements& measurements,
                const Estimate& estimate, Doubts& doubts);

}  // namespace posewise
