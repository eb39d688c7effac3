#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "posewise/core/types.hpp"

/// Numbers that answer what people ask of a result first; posewise/report/reports.hpp has the
/// sentences.
namespace posewise {

/// A question and its answer, the same in text, JSON and page.
struct Answer {
    std::string key;       ///< "accuracy"
    std::string question;  ///< "How accurate"
    std::string text;      ///< one or two sentences
};

/// How the residuals of one axis change in the order of the measurements.
struct OrderSlope {
    std::string axis;        ///< as in residual_axes()
    bool is_angle = false;   ///< rad below, else m
    double change = 0;       ///< from the first to the last configuration, by a straight line
    double detectable = 0;   ///< a change that would be seen with 95 % confidence
    double early = 0;        ///< mean of the first tenth less that of the others
    double probability = 1;  ///< that chance alone makes one of the axes change as much
    double error = 0;        ///< standard deviation of the change
};

/// Whether residuals follow the order of the measurements, as those of a robot that warms up or of
/// an instrument that drifts do.
struct OrderTrend {
    std::vector<OrderSlope> slopes;  ///< at least one
    std::size_t strongest = 0;       ///< the one least likely by chance
    /// Effects of the joints' positions were removed first, so that an order of the poses
    /// themselves does not look like drift. False: too few configurations to do so.
    bool is_beside_joints = false;

    const OrderSlope& worst() const { return slopes[strongest]; }
    bool is_plain() const { return worst().probability < 0.01; }
    bool is_possible() const { return worst().probability < 0.05; }
};

/// What was noted beside measurements, such as the time or a temperature.
struct Condition {
    std::string name;                      ///< "time"
    std::string unit;                      ///< "h"
    std::map<std::string, double> values;  ///< by configuration id, in that unit
};

/// Whether residuals follow a condition, by a straight line.
struct ConditionTrend {
    std::string name;
    std::string unit;
    double range = 0;  ///< from the least to the largest value, over which slopes change
    OrderTrend trend;  ///< whose slopes have no `early`
};

/// The configuration that the others predict worst, compared with how it is fitted.
struct Influence {
    std::string id;
    double fit = 0;       ///< RMS of its residuals with itself used, m (rad without lengths)
    double held_out = 0;  ///< predicted without it and, if not `is_alone`, without its group
    bool is_alone = false;
};

/// Where in a camera's image corners of the board were seen. The image is cut into cells, 8 along
/// its longer side and 6 along the other.
struct ImageCoverage {
    Index camera = 0;              ///< of its sensor, from 0
    std::array<double, 2> size{};  ///< width and height, px
    Index columns = 0;
    Index rows = 0;
    std::vector<Index> counts;  ///< corners seen in each cell, row by row from the top left
    double part = 0;            ///< share of the cells that have a corner, 0 to 1
    /// The zones without a corner, out of nine: "top left", "top", ..., "middle". Outer zones are
    /// two cells wide.
    std::vector<std::string> empty;
    std::string name{};             ///< CameraImage::name
    std::optional<Index> sensor{};  ///< whose camera it is, of several sensors, from 0
};

/// An error, m, at a number of poses.
struct ErrorAtCount {
    Index pose_count = 0;
    double error = 0;  ///< as expected
    /// As small and as large as it may turn out (5 and 95 %); 0: not known.
    double lower = 0;
    double upper = 0;
    bool has_ends() const { return lower > 0 && upper > 0; }
};

/// A number that is not known for sure: nothing stands for "no number does".
struct CountBand {
    std::optional<Index> expected;
    std::optional<Index> lower;  ///< suffices with 5 % probability
    std::optional<Index> upper;  ///< with 95 %
};

/// How many more poses leave 80 % of an error.
struct MorePoses {
    CountBand more;    ///< nothing: no count up to `most` does
    Index most = 0;    ///< the largest count known
    double ratio = 1;  ///< error with the `more` expected, or at `most`, divided by that now
};
/// Interpolated between the points on logarithmic axes; as expected for the ends of the band if the
/// points have none. Nothing if `count` is not among their range.
std::optional<MorePoses> more_poses(std::vector<ErrorAtCount> points, Index count);

}  // namespace posewise
