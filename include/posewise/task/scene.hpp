#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

/// What there is to draw of a robot and of what stands around it. m and rad; places are in the
/// world, that of the measurements.
namespace posewise {

/// A solid of the robot, or of its cell.
struct SceneCapsule {
    std::string name;
    Index after_element = 0;   ///< fixed to the frame after so many elements; 0: the base
    Capsule solid;             ///< in that frame
    bool is_obstacle = false;  ///< of the cell
};

struct SceneBox {
    std::string name;
    Isometry3d world_from_box = Isometry3d::Identity();  ///< of its centre
    Vector3d size = Vector3d::Zero();                    ///< lengths of its edges
    bool is_obstacle = false;                            ///< else targets shall be in it
};

/// Everything behind it is closed.
struct SceneWall {
    std::string name;
    Vector3d point = Vector3d::Zero();
    Vector3d normal = Vector3d::UnitZ();  ///< to the free side
};

struct SceneTarget {
    std::string name;
    Vector3d position = Vector3d::Zero();  ///< in the flange frame
};

struct SceneInstrument {
    std::string kind;  ///< "tracker"
    Vector3d position = Vector3d::Zero();
};

struct Scene {
    /// Constant errors are part of its elements, what depends on the configuration otherwise than
    /// by its joints is left out. Elements that do nothing are, too.
    Chain robot;
    Isometry3d world_from_base = Isometry3d::Identity();
    std::vector<SceneTarget> targets;
    std::vector<SceneCapsule> capsules;
    std::vector<SceneBox> boxes;
    std::vector<SceneWall> walls;
    std::optional<double> floor_z;              ///< height of a wall that is level
    std::optional<SceneInstrument> instrument;  ///< if it is known where it stands
};

/// The robot with these parameters and its cell.
Scene make_scene(const Campaign& campaign, const Parameters& parameters);

/// The same before any calibration: base and targets as the measurements show them, as far as they
/// do, else as the campaign expects them. Throws InputError for measurements that do not fit it.
Scene make_scene(const Campaign& campaign, const Measurements* measurements = nullptr);

/// Where a scene's robot has its flange. `configuration` may have measured torques behind the
/// joints; they are not looked at.
Isometry3d world_from_flange(const Scene& scene, const VectorXd& configuration);

/// Where its arm is then: the places of the base, of each joint, of the flange and of the targets'
/// centre, in the base frame.
std::vector<Vector3d> arm_places(const Scene& scene, const VectorXd& configuration);

/// Where the instrument stands in the world, if the campaign tells: that of a laser tracker's
/// noise, or of a cell that says what it sees.
std::optional<Vector3d> instrument_position(const Campaign& campaign);

/// Of each target() of the campaign's sensor: "target1", the name of a socket, or for other sensors
/// that of the reading.
std::vector<std::string> reading_names(const Campaign& campaign);

}  // namespace posewise
