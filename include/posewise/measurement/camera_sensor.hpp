#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "posewise/measurement/sensor.hpp"

namespace posewise {

using Vector2d = Eigen::Vector2d;

/// How a lens departs from a pinhole. Names and formulas are OpenCV's.
enum class Distortion {
    None,
    BrownConrady,  ///< k1 k2 p1 p2, then k3, then k4 k5 k6: 4, 5 or 8 coefficients
    Fisheye        ///< k1 k2 k3 k4 [Kannala & Brandt 2006]
};

/// A camera's intrinsic parameters: a point (x, y, z) of its frame (z forwards, x to the right of
/// the image, y down) is seen at u = fx a + cx, v = fy b + cy, where (a, b) is (x/z, y/z)
/// distorted.
struct Intrinsics {
    double fx = 0, fy = 0, cx = 0, cy = 0;  ///< px
    Distortion distortion = Distortion::None;
    std::vector<double> coefficients;

    /// fx, fy, cx, cy in thousands of pixels, then the coefficients.
    VectorXd values() const;
    /// These intrinsics, with other numbers in the order of values().
    Intrinsics with(const VectorXd& values) const;
    /// "fx", "fy", "cx", "cy", "k1", ...
    std::vector<std::string> names() const;
};

/// Throws InputError if a focal length is not above 0, a number not finite, or the number of
/// coefficients not one of the model's.
void check_intrinsics(const Intrinsics& intrinsics);

/// Where a point of the camera's frame is seen, px. With z = 0 it counts as 1 um before the camera;
/// what is behind it is seen through its centre.
Vector2d project(const Intrinsics& intrinsics, const Vector3d& point);

/// Direction (x/z, y/z) of a place in the image, px; nothing where the distortion has no inverse.
std::optional<Vector2d> undistort(const Intrinsics& intrinsics, const Vector2d& pixel);

/// What must hold for a corner to count as seen when poses are planned.
struct CameraView {
    double most_tilt =
        1.0471975511965976;        ///< rad, between the board's normal and the line of sight
    bool is_front_plus_z = false;  ///< which side of the board bears the pattern; else minus z
    Index least_corners = 4;       ///< a pose must show
    /// Depths between which a corner is seen, m: sharply, say, or within the camera's reach.
    double nearest = 0, farthest = std::numeric_limits<double>::infinity();
    bool is_line_required = true;  ///< whether links and keep-outs of the cell hide corners
};

/// How the noise of a corner grows. With its standard deviation sigma where it is seen straight on
/// and in focus, it is
///     sigma (1 / cos t)^tilt sqrt(1 + b^2),    b = fx aperture |1/z - 1/focus|
/// at an angle t between a plane board's normal and the line of sight, and a depth z. The pattern
/// is cos t times as long across the axis about which it is tilted: tilt is 1 where the noise grows
/// as that length shrinks, 0.5 as the number of pixels does. b is the blur's width in px, by the
/// thin lens: the image of a point at z would be sharp at v' with 1/v' - 1/v = 1/focus - 1/z, v the
/// image's distance (fx in px), so that its cone is aperture v |1/v' - 1/v| wide. A sharp edge is
/// 1 px wide, the squares of widths add up, and a corner is found to a part of that width.
struct NoiseGrowth {
    double tilt = 0;                ///< 0: with none
    std::optional<double> focus{};  ///< depth that is in focus, m; nothing: all depths are
    double aperture = 0;            ///< diameter, m: the focal length divided by the f-number

    bool is_none() const { return tilt == 0 && !focus; }
};

/// A lens and what is behind it.
struct SingleCamera {
    Intrinsics intrinsics;  ///< unknown ones: where a search begins; 0: from what is seen
    /// Which of Intrinsics::values() are known; empty: all.
    std::vector<bool> is_known;
    /// Standard deviations of those that are known about their stated values, in the units of
    /// Intrinsics::values(); 0: exact. Empty: all are. Errors above 0 are unknowns of known size.
    std::vector<double> deviations{};
    double sigma = 0;               ///< standard deviation of u and of v, px
    std::optional<Vector2d> image;  ///< width and height, px; nothing: any place
    NoiseGrowth growth{};
};

/// A further camera: where it is in the first one's frame, its lens and its image.
struct PlacedCamera {
    Isometry3d in_first = Isometry3d::Identity();
    Intrinsics intrinsics;
    std::optional<Vector2d> image{};
};

/// What is printed on a board, for those who draw it or find it in images.
struct BoardPattern {
    enum class Kind {
        Points,      ///< none: corners or markers that stand alone
        Chessboard,  ///< of columns x rows inner corners, which are the board's corners
        Charuco,     ///< of columns x rows squares: the corners are those inside, as OpenCV counts
        Aprilgrid    ///< of columns x rows tags: the corners are theirs, as Kalibr counts
    };
    Kind kind = Kind::Points;
    Index columns = 0, rows = 0;
    double marker = 0;         ///< side of a marker or tag with its black border, m
    bool is_legacy = false;    ///< a ChArUco board whose first square is white
    std::string dictionary{};  ///< of markers or tags, as OpenCV names it: "DICT_4X4_50"
};

/// A camera that sees corners of a board, or several that are fixed to each other.
struct CameraSetup : SingleCamera {
    /// The camera is on the flange, the board is the world; else the board is on the flange and the
    /// camera's frame is the world.
    bool is_on_flange = false;
    /// Pose of the board, or of the camera, in the flange frame; nothing: six unknowns.
    std::optional<Isometry3d> known_place;
    std::vector<Vector3d> corners;  ///< in the board's frame, m
    /// Standard deviation of each coordinate of a corner about the stated one, m. Above 0: the
    /// corners' errors are unknowns, whose sizes are known.
    double corner_sigma = 0;
    Index first_corner = 1;  ///< number of the first one in files
    BoardPattern pattern{};
    /// Whether the board may be larger or smaller than stated by a factor, 1 + board.scale, which
    /// is then the last unknown.
    bool is_scale_unknown = false;
    CameraView view{};
    /// Further cameras that see the same board. Where each is in the first one's frame is unknown.
    std::vector<SingleCamera> others{};

    /// The first camera is number 0.
    const SingleCamera& camera(Index number) const {
        if (number == 0) return *this;
        return others[static_cast<std::size_t>(number - 1)];
    }
    SingleCamera& camera(Index number) {
        if (number == 0) return *this;
        return others[static_cast<std::size_t>(number - 1)];
    }
    /// "camera" or "board".
    std::string on_flange() const { return is_on_flange ? "camera" : "board"; }
};

/// A camera that returns the places of n corners in its image, two numbers each, u and v, in
/// thousands of pixels (pixel_units). Corners are seen or missed by themselves. Unknowns: errors of
/// the corners' places, board.p1.x ..., and of intrinsic parameters known with a deviation,
/// camera.dfx ...; the pose in the flange frame of what is on it (position and
/// rotation vector, board.x to board.rz or camera.x to camera.rz); the unknown intrinsic
/// parameters, camera.fx to camera.k6; of each further camera its pose in the first one's frame and
/// the same, camera2.x to camera2.k6; board.scale. A target is a corner in one camera's image: all
/// corners of the first camera, then those of the next.
class CameraSensor final : public Sensor {
  public:
    /// Throws InputError if there are fewer than 4 corners, if all are in line, if a number is not
    /// finite, if sigma is below 1e-12 px, if it grows with the tilt of a board that is no plane,
    /// if no depth is in view, or as check_intrinsics(); unknown intrinsics may be 0.
    explicit CameraSensor(CameraSetup setup);

    const CameraSetup& setup() const { return setup_; }
    /// Pose of board or camera in the flange frame.
    Isometry3d place(const VectorXd& unknowns) const;
    /// Cameras count from 0.
    Index camera_count() const { return 1 + static_cast<Index>(setup_.others.size()); }
    const SingleCamera& camera(Index camera) const { return setup_.camera(camera); }
    /// Where a camera is in the first one's frame, and its lens.
    PlacedCamera placed(Index camera, const VectorXd& unknowns) const;
    /// All but the first.
    std::vector<PlacedCamera> placed_others(const VectorXd& unknowns) const;
    Intrinsics intrinsics(const VectorXd& unknowns) const { return placed(0, unknowns).intrinsics; }
    /// Which of Intrinsics::values() are unknown.
    const std::vector<Index>& unknown_intrinsics(Index camera) const {
        return own_[static_cast<std::size_t>(camera)].intrinsics;
    }
    /// The first of a camera's unknowns: of the first camera intrinsic parameters, of another its
    /// pose.
    Index first_unknown(Index camera) const { return own_[static_cast<std::size_t>(camera)].first; }
    /// The first of its intrinsic parameters, after the pose of another than the first camera.
    Index first_intrinsic(Index camera) const {
        return first_unknown(camera) + (camera > 0 ? 6 : 0);
    }
    /// Largest x/z at which a camera's lens as stated does not fold the image.
    double widest(Index camera) const { return own_[static_cast<std::size_t>(camera)].widest; }
    Index corner_count() const { return static_cast<Index>(setup_.corners.size()); }
    /// How many times as large as stated the board is.
    double board_factor(const VectorXd& unknowns) const {
        return setup_.is_scale_unknown ? 1 + unknowns[unknowns.size() - 1] : 1;
    }
    /// Place of a corner (from 0) in the board's frame.
    Vector3d corner(Index k, const VectorXd& unknowns) const {
        const Vector3d place = board_factor(unknowns) * setup_.corners[static_cast<std::size_t>(k)];
        if (corner_error_count() == 0) return place;
        return place + unknowns.segment<3>(3 * k);
    }
    /// Unknowns that are errors of corners' places, before all others: none, or three a corner.
    Index corner_error_count() const { return setup_.corner_sigma > 0 ? 3 * corner_count() : 0; }
    /// Which of Intrinsics::values() have an error of known size, and the first of these unknowns.
    const std::vector<Index>& doubtful_intrinsics(Index camera) const {
        return own_[static_cast<std::size_t>(camera)].doubtful;
    }
    Index first_intrinsic_error(Index camera) const {
        return own_[static_cast<std::size_t>(camera)].first_error;
    }
    /// The first of six unknowns, the pose of what is on the flange, where that is not known.
    Index first_of_place() const { return sizes_.size(); }
    /// The board as stated in the first camera's frame.
    Isometry3d camera_from_board(const Isometry3d& world_from_flange,
                                 const VectorXd& unknowns) const;
    /// Whether a camera sees a plane board's origin from behind its front.
    bool is_seen_from_back(Index camera, const Isometry3d& world_from_flange,
                           const VectorXd& unknowns) const;
    /// RMS of u and v about the pose of the board that suits what one camera sees best, px:
    /// infinite if none is seen so. Nothing: fewer than four corners are seen, or only some in one
    /// line.
    std::optional<double> left_by_any_pose(Index camera, const VectorXd& unknowns,
                                           const ConstNumbers& observation,
                                           const SeenTargets& is_seen) const;
    /// Unknowns for a pose of board or camera and intrinsic parameters, and further cameras.
    VectorXd unknowns(const Isometry3d& place, const Intrinsics& intrinsics,
                      const std::vector<PlacedCamera>& others = {}) const;

    /// The origin of board or camera.
    const Targets& targets() const override { return origin_; }
    Index target_count() const override { return camera_count() * corner_count(); }
    Index row_count() const override { return 2 * target_count(); }
    bool is_angle(Index) const override { return true; }
    bool has_pixels() const override { return true; }
    std::vector<std::string> observation_names() const override;
    std::vector<std::string> unknown_names() const override;
    std::vector<bool> unknown_is_angle() const override;
    std::vector<const AmountUnits*> unknown_units() const override;
    VectorXd unknown_sizes() const override { return sizes_; }
    using Sensor::covariance;
    using Sensor::predict;
    void predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                 Eigen::Ref<VectorXd> observation) const override;
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns,
                       Eigen::Ref<RowMatrixXd> J_measured_parameters) const override;
    void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                             const Twist& direction, const TwistMatrix& twist_rates,
                             const VectorXd& unknowns,
                             Eigen::Ref<RowMatrixXd> J_rate) const override;
    void covariance(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                    Eigen::Ref<MatrixXd> covariance) const override;
    MatrixXd covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                             const VectorXd& unknowns) const override;
    bool has_constant_covariance() const override;
    bool has_view() const override { return true; }
    bool is_readable(Index target, const ConstNumbers& observation) const override;
    void view_clearances(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                         Eigen::Ref<VectorXd> clearances) const override;
    SightLines sight_lines(const Isometry3d& world_from_flange,
                           const VectorXd& unknowns) const override;
    Index least_in_view() const override { return setup_.view.least_corners; }
    std::vector<NoiseNumber> noise_numbers() const override;
    SensorWords words() const override;
    /// Four points of what is on the flange: its origin and one on each axis, from the board's pose
    /// in the camera's frame by the corners seen.
    std::optional<ObservedPoints> observed_points() const override;
    /// Unknown intrinsic parameters are first found from the views [Zhang 2000].
    std::optional<ObservedPoints> observed_points(const Measurements& means) const override;

    /// Whether the board's corners are exactly where they are stated. Views are compared with each
    /// other only then: few corners that are not often find no good pose of the board.
    bool has_exact_corners() const { return corner_error_count() == 0; }

  private:
    bool has_unknown_place() const { return !setup_.known_place; }
    /// `most_left`: of each camera, what a view of the board may leave over, px.
    ObservedPoints points_with(const std::vector<PlacedCamera>& cameras,
                               const std::vector<double>& most_left) const;

    struct OwnUnknowns {
        Index first = 0;
        std::vector<Index> intrinsics;  ///< indices among Intrinsics::values()
        Index first_error = 0;
        std::vector<Index> doubtful{};  ///< likewise, of those with an error of known size
        double widest = 1e3;
    };

    CameraSetup setup_;
    Targets origin_;                  ///< where what is on the flange has its origin
    std::optional<Vector3d> normal_;  ///< away from the front of a plane board, in its frame
    std::vector<OwnUnknowns> own_;    ///< one for each camera
    VectorXd sizes_;                  ///< unknown_sizes()
    Index unknown_count_ = 0;
};

/// Number of the first target in files that list corners, CameraSetup::first_corner.
Index first_corner(const Sensor& sensor);
/// How many cameras a sensor has: 1 if it is none.
Index camera_count(const Sensor& sensor);
/// CameraSensor::has_exact_corners(); of another sensor whether no unknown has a known size.
bool has_exact_corners(const Sensor& sensor);

}  // namespace posewise
