#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/inspection.hpp"
#include "posewise/task/planning.hpp"

/// Geometry to draw: a robot and its surroundings, in m and rad. Places are in the world frame,
/// that of the measurements.
namespace posewise {

/// A solid of the robot, or of its cell.
struct SceneCapsule {
    std::string name;
    Index after_element = 0;   ///< fixed to the frame after this many elements; 0: the base
    Capsule solid;             ///< in that frame
    bool is_obstacle = false;  ///< belongs to the cell
};

struct SceneBox {
    std::string name;
    Isometry3d world_from_box = Isometry3d::Identity();  ///< pose of its centre
    Vector3d size = Vector3d::Zero();                    ///< lengths of the edges
    bool is_obstacle = false;                            ///< else targets shall be in it
};

/// A plane; its other side is closed.
struct SceneWall {
    std::string name;
    Vector3d point = Vector3d::Zero();
    Vector3d normal = Vector3d::UnitZ();  ///< points to the free side
};

struct SceneTarget {
    std::string name;
    Vector3d position = Vector3d::Zero();  ///< in the flange frame
};

struct SceneInstrument {
    std::string kind;  ///< "tracker"
    Vector3d position = Vector3d::Zero();
};

/// A camera and how far it sees to each side.
struct SceneCamera {
    Isometry3d in_first = Isometry3d::Identity();  ///< its place in the first camera's frame
    /// Left, top, right and bottom of its image as x/z and y/z, without distortion.
    std::array<double, 4> window{};
};

/// Cameras and what they see. What is not on the flange stands in the world's origin.
struct SceneViews {
    bool is_camera_on_flange = false;  ///< else the board is
    Isometry3d flange_from_it =
        Isometry3d::Identity();  ///< place of the first camera, or the board
    std::vector<SceneCamera> cameras;
    std::vector<Vector3d> corners;  ///< of the board, in its frame
};

struct Scene {
    /// Its elements include constant errors. What else depends on the configuration than the joints
    /// is left out, and so are elements that do nothing.
    Chain robot;
    Isometry3d world_from_base = Isometry3d::Identity();
    std::vector<SceneTarget> targets;
    std::vector<SceneCapsule> capsules;
    std::vector<SceneBox> boxes;
    std::vector<SceneWall> walls;
    std::optional<double> floor_z;              ///< height of a level wall
    std::optional<SceneInstrument> instrument;  ///< if its place is known
    std::optional<SceneViews> views{};          ///< of a sensor that is a camera
};

/// The robot with these parameters and its cell.
Scene make_scene(const Campaign& campaign, const Parameters& parameters);

/// The scene before any calibration: base and targets as the measurements show them, as far as they
/// do, else as the campaign expects them. Throws InputError for measurements that do not fit it.
Scene make_scene(const Campaign& campaign, const Measurements* measurements = nullptr);

/// Flange pose of a scene's robot. `configuration` may have measured torques after the joints; they
/// are ignored.
Isometry3d world_from_flange(const Scene& scene, const VectorXd& configuration);

/// Places of its arm, in the base frame: the base, each joint, the flange and the targets' centre.
std::vector<Vector3d> arm_places(const Scene& scene, const VectorXd& configuration);

/// Where the instrument stands in the world, if the campaign says so: by a laser tracker's noise,
/// or by a cell that states what it sees.
std::optional<Vector3d> instrument_position(const Campaign& campaign);

/// Name of each target that the campaign's sensor reads: "target1", the name of a socket, or for
/// other sensors that of the reading.
std::vector<std::string> reading_names(const Campaign& campaign);

// How accurate a robot will be over its workspace.

/// The error at one configuration.
struct MappedError {
    VectorXd configuration;                ///< rad or m (and N m of measured torques)
    Vector3d position = Vector3d::Zero();  ///< first target in the world, m
    double predicted = 0;  ///< RMS position error of the targets due to the parameters, m
    std::optional<Vector3d> displacement{};  ///< the first target's, m; see map_errors()
};
using ErrorMap = std::vector<MappedError>;

/// For a plan that make_plan() made with these options, over its workspace and the target that
/// counts: the RMS of all is that of Plan::predicted. Throws InputError as make_plan(), and if the
/// poses do not identify the parameters.
ErrorMap map_errors(const Plan& plan, const Campaign& campaign, const PlanningOptions& options);

/// For a choice by choose(), over as many of its candidates as Plan::predicted.
ErrorMap map_errors(const Plan& plan, const Campaign& campaign, const Candidates& candidates,
                    const ChoiceOptions& options);

/// For a calibrated robot, over a workspace drawn as in estimated_geometry(). The displacement is
/// that of the first target from the nominal robot to the robot found, with base and targets of the
/// nominal one fitted over the workspace unless they are known. Throws InputError as
/// estimated_geometry().
ErrorMap map_errors(const Campaign& campaign, const Estimate& estimate,
                    const GeometryOptions& options = {{}, 500});

}  // namespace posewise
