#include "posewise/task/scene.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "measurement/places.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise {
namespace {

/// The robot as it is drawn, and how many of its elements are left of the first k.
struct SceneRobot {
    Chain robot;
    std::vector<Index> count_of;
};

/// Constant errors in the elements; others left out.
SceneRobot drawn_robot(const Chain& robot, const VectorXd& errors) {
    std::vector<Element> elements;
    std::vector<Index> count_of{0};
    Index k = 0;
    for (const Element& element : robot.elements()) {
        double amount = element.value;
        if (!element.parameter.empty()) amount += errors[k++];
        k += std::ssize(element.terms);
        if (amount != 0 || !element.joints.empty()) {
            elements.push_back({element.motion, element.axis, amount, element.joints});
        }
        count_of.push_back(std::ssize(elements));
    }
    return {Chain(robot.joints(), std::move(elements)), std::move(count_of)};
}

/// How many elements there are up to each frame that links are fixed to, see
/// Chain::base_from_links().
std::vector<Index> elements_up_to_frames(const Chain& robot) {
    std::vector<Index> counts(static_cast<std::size_t>(robot.joint_count()) + 2, 0);
    Index k = 0;
    for (const Element& element : robot.elements()) {
        ++k;
        for (const JointTerm& term : element.joints) {
            Index& count = counts[static_cast<std::size_t>(term.joint) + 1];
            if (count == 0) count = k;
        }
    }
    counts.back() = k;
    return counts;
}

SceneBox make_box(const Isometry3d& world_from_base, const std::string& name, const Box& box,
                  bool is_obstacle) {
    const Vector3d centre = (box.lower + box.upper) / 2;
    return {name, world_from_base * Eigen::Translation3d(centre), box.upper - box.lower,
            is_obstacle};
}

/// A solid of the cell, which is stated in the base frame.
struct AddSolid {
    Scene& scene;
    const std::string& name;

    void operator()(const Box& box) const {
        scene.boxes.push_back(make_box(scene.world_from_base, name, box, true));
    }
    void operator()(const Sphere& sphere) const {
        (*this)(Capsule{sphere.center, sphere.center, sphere.radius});
    }
    void operator()(const Capsule& capsule) const {
        scene.capsules.push_back({name, 0, capsule, true});
    }
    void operator()(const HalfSpace& half_space) const {
        constexpr double level = 0.9998;  // 1 deg
        const Vector3d point = scene.world_from_base * half_space.point;
        const Vector3d normal = scene.world_from_base.linear() * half_space.normal;
        if (normal.z() > level && !scene.floor_z) {
            // Below the robot: another place of a floor that is not quite level is another height.
            const Vector3d base = scene.world_from_base.translation();
            scene.floor_z = base.z() - normal.dot(base - point) / normal.z();
        } else {
            scene.walls.push_back({name, point, normal});
        }
    }
};

void add_cell(Scene& scene, const Campaign& campaign, const std::vector<Index>& count_of) {
    const Cell& cell = campaign.cell;
    const std::vector<Index> counts = elements_up_to_frames(campaign.robot);
    for (const Link& link : cell.links) {
        const Index count = counts[static_cast<std::size_t>(link.frame)];
        scene.capsules.push_back(
            {link.name, count_of[static_cast<std::size_t>(count)], link.solid, false});
    }
    for (const KeepOut& keep_out : cell.keep_outs) {
        std::visit(AddSolid{scene, keep_out.name}, keep_out.solid);
    }
    for (const Box& box : cell.target_boxes) {
        scene.boxes.push_back(make_box(scene.world_from_base, "targets", box, false));
    }
}

/// Without a stated size the image is taken to be centred about the principal point; a lens that is
/// to be found from the views is taken to see 53 deg.
std::array<double, 4> window_of(const PlacedCamera& camera) {
    const Intrinsics& lens = camera.intrinsics;
    if (!(lens.fx > 0 && lens.fy > 0)) return {-0.5, -0.5, 0.5, 0.5};
    const Vector2d size = camera.image ? *camera.image : Vector2d(2 * lens.cx, 2 * lens.cy);
    return {-lens.cx / lens.fx, -lens.cy / lens.fy, (size.x() - lens.cx) / lens.fx,
            (size.y() - lens.cy) / lens.fy};
}

std::optional<SceneViews> views_of(const Campaign& campaign, const Parameters& parameters) {
    const auto* const sensor = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    if (sensor == nullptr) return std::nullopt;
    SceneViews views{sensor->setup().is_on_flange, sensor->place(parameters.sensor), {}, {}};
    for (Index c = 0; c < sensor->camera_count(); ++c) {
        const PlacedCamera camera = sensor->placed(c, parameters.sensor);
        views.cameras.push_back({camera.in_first, window_of(camera)});
    }
    for (Index k = 0; k < sensor->corner_count(); ++k) {
        views.corners.push_back(sensor->corner(k, parameters.sensor));
    }
    return views;
}

}  // namespace

Scene make_scene(const Campaign& campaign, const Parameters& parameters) {
    const SceneRobot drawn = drawn_robot(campaign.robot, parameters.robot);
    Scene scene;
    scene.robot = drawn.robot;
    scene.world_from_base = parameters.world_from_base;
    const Targets& targets = campaign.sensor->targets();
    for (Index k = 0; k < targets.count(); ++k) {
        scene.targets.push_back(
            {"target" + std::to_string(k + 1), targets.position(k, parameters.sensor)});
    }
    add_cell(scene, campaign, drawn.count_of);
    if (const auto position = instrument_position(campaign)) {
        scene.instrument = SceneInstrument{"tracker", *position};
    }
    scene.views = views_of(campaign, parameters);
    return scene;
}

Scene make_scene(const Campaign& campaign, const Measurements* measurements) {
    if (measurements == nullptr) return make_scene(campaign, campaign.nominal);
    const Registration registered = register_base_and_targets(campaign, *measurements);
    return make_scene(campaign,
                      registered.is_determined() ? registered.parameters : campaign.nominal);
}

Isometry3d world_from_flange(const Scene& scene, const VectorXd& configuration) {
    return scene.world_from_base *
           scene.robot.base_from_flange(configuration.head(scene.robot.joint_count()), VectorXd());
}

std::vector<Vector3d> arm_places(const Scene& scene, const VectorXd& configuration) {
    const std::vector<Isometry3d> frames =
        scene.robot.base_from_links(configuration.head(scene.robot.joint_count()), VectorXd());
    std::vector<Vector3d> places;
    for (const Isometry3d& frame : frames) places.push_back(frame.translation());
    Vector3d centre = Vector3d::Zero();
    for (const SceneTarget& target : scene.targets) centre += target.position;
    const auto count = static_cast<double>(scene.targets.size());
    places.emplace_back(frames.back() * Vector3d(centre / std::max(count, 1.0)));
    return places;
}

std::optional<Vector3d> instrument_position(const Campaign& campaign) {
    return detail::tracker_position(campaign);
}

std::vector<std::string> reading_names(const Campaign& campaign) {
    const Sensor& sensor = *campaign.sensor;
    if (sensor.has_contacts()) return sensor.contact_names();
    const bool are_targets =
        sensor.target_count() == sensor.targets().count() && !sensor.is_combined();
    const std::vector<std::string> numbers = sensor.observation_names();
    std::vector<std::string> names;
    for (Index k = 0; k < sensor.target_count(); ++k) {
        names.push_back(are_targets ? "target" + std::to_string(k + 1)
                                    : numbers[static_cast<std::size_t>(sensor.first_row(k))]);
    }
    return names;
}

}  // namespace posewise
