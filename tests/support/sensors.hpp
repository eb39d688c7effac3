#pragma once

#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/sensors.hpp"
#include "support/campaigns.hpp"

namespace posewise::testing {

/// One campaign for each kind of sensor and of what is known about it.
struct SensorCampaign {
    std::string name;
    Campaign campaign;
};

inline Campaign with_sensor(const Campaign& from, std::shared_ptr<const Sensor> sensor,
                            const VectorXd& unknowns, bool is_base_known = false) {
    Campaign campaign = from;
    campaign.sensor = std::move(sensor);
    campaign.nominal.sensor = unknowns;
    campaign.base_is_known.fill(is_base_known);
    return campaign;
}

/// Corners of a chessboard, as OpenCV has them: rows downwards (y), in each to the right (x).
inline std::vector<Vector3d> chessboard(Index columns, Index rows, double square) {
    std::vector<Vector3d> corners;
    for (Index k = 0; k < rows * columns; ++k) {
        corners.emplace_back(square * static_cast<double>(k % columns),
                             square * static_cast<double>(k / columns), 0);
    }
    return corners;
}

/// A camera with a lens of 5 coefficients before the robot, the board on its flange.
inline CameraSetup fixed_camera() {
    CameraSetup setup;
    setup.corners = chessboard(4, 3, 0.1);
    setup.intrinsics = {
        1210, 1190, 655, 470, Distortion::BrownConrady, {-0.12, 0.05, 1e-3, -2e-3, 0.01}};
    setup.sigma = 0.1;
    setup.image = Vector2d(1280, 960);
    return setup;
}

/// A camera with a fisheye on the flange, its intrinsic parameters unknown.
inline CameraSetup camera_on_flange() {
    CameraSetup setup = fixed_camera();
    setup.is_on_flange = true;
    setup.intrinsics = {700, 710, 650, 490, Distortion::Fisheye, {0.02, -0.01, 0.003, -0.001}};
    setup.is_known.assign(8, false);
    setup.is_known[3] = true;
    return setup;
}

/// A fixed camera before the corners of a cube, whose places are known to a millimetre.
inline CameraSetup camera_before_cube() {
    CameraSetup setup = fixed_camera();
    setup.corners.clear();
    for (const double z : {0.0, 0.1}) {
        for (const double y : {0.0, 0.1}) {
            for (const double x : {0.0, 0.1}) setup.corners.emplace_back(x, y, z);
        }
    }
    setup.corner_sigma = 1e-3;
    return setup;
}

/// A fixed camera of which some intrinsic parameters are known with a deviation, k2 is not known,
/// and a further one like it.
inline CameraSetup roughly_known_camera() {
    CameraSetup setup = fixed_camera();
    setup.deviations = {2e-3, 2e-3, 4e-3, 4e-3, 0.01, 0, 0, 0, 0};
    setup.is_known = {true, true, true, true, true, false, true, true, true};
    setup.others = {setup};
    return setup;
}

/// Two cameras that are fixed to each other, one more whose intrinsic parameters are unknown.
inline CameraSetup three_cameras() {
    CameraSetup setup = fixed_camera();
    setup.others = {setup, setup};
    setup.others[0].sigma = 0.2;
    setup.others[1].is_known.assign(9, false);
    return setup;
}

/// Two cameras whose corners are noisier when tilted and out of focus, each by its own.
inline CameraSetup cameras_with_focus() {
    CameraSetup setup = fixed_camera();
    setup.others = {setup};
    setup.growth = {1, 2.5, 4e-3};
    setup.others[0].growth = {0.5, std::nullopt, 0};
    return setup;
}

/// Where the further ones of three cameras are in the first one's frame.
inline std::vector<PlacedCamera> beside_first(const CameraSetup& setup) {
    std::vector<PlacedCamera> placed;
    for (const SingleCamera& other : setup.others) {
        const double side = placed.empty() ? 0.5 : -0.4;
        placed.push_back({Eigen::Translation3d(side, 0.1, 0.2) *
                              Eigen::AngleAxisd(-0.15 * side, Vector3d(0.2, 1, 0).normalized()),
                          other.intrinsics});
    }
    return placed;
}

/// The robot 3 m before the camera, or before the front of the board, whose z axis points away.
inline Campaign before_camera(const Campaign& from, const CameraSetup& setup) {
    const auto sensor = std::make_shared<CameraSensor>(setup);
    Isometry3d place(Eigen::AngleAxisd(0.4, Vector3d(1, -2, 0.5).normalized()));
    place.translation() = Vector3d(0.1, -0.05, 0.2);
    Campaign campaign =
        with_sensor(from, sensor, sensor->unknowns(place, setup.intrinsics, beside_first(setup)));
    campaign.nominal.world_from_base = Eigen::Translation3d(0.2, 0.1, setup.is_on_flange ? -3 : 3) *
                                       Eigen::AngleAxisd(2, Vector3d(0.3, 1, -0.2).normalized());
    return campaign;
}

/// Several instruments, of which each further one has its own campaign of the same robot. Where
/// its frame is in the first one's follows from the two bases; it is unknown, or known.
inline Campaign combined_campaign(const Campaign& first, const std::vector<Campaign>& others,
                                  bool are_frames_known = false) {
    std::vector<SensorPart> parts{{first.sensor}};
    std::vector<VectorXd> unknowns{first.nominal.sensor};
    std::vector<Isometry3d> frames{Isometry3d::Identity()};
    for (const Campaign& other : others) {
        frames.push_back(first.nominal.world_from_base * other.nominal.world_from_base.inverse());
        parts.push_back({other.sensor, are_frames_known ? std::optional(frames.back())
                                                        : std::optional<Isometry3d>()});
        unknowns.push_back(other.nominal.sensor);
    }
    const auto sensor = std::make_shared<CombinedSensor>(std::move(parts));
    return with_sensor(first, sensor, sensor->unknowns(unknowns, frames));
}

/// One camera that sees two boards, the second one 0.3 m beside the first, on the same side of it.
inline Campaign two_boards(const Campaign& from, const CameraSetup& setup) {
    const Campaign first = before_camera(from, setup);
    CameraSetup other = setup;
    other.corners = chessboard(3, 3, 0.08);
    const auto second = std::make_shared<CameraSensor>(other);
    Isometry3d beside(Eigen::AngleAxisd(0.3, Vector3d(1, 0.5, 0.2).normalized()));
    beside.translation() = Vector3d(0.3, 0.1, -0.1);
    const auto sensor = std::make_shared<CombinedSensor>(std::vector<SensorPart>{
        {first.sensor},
        {second, setup.is_on_flange ? std::optional<Isometry3d>() : Isometry3d::Identity(), true,
         true, 0}});
    const Isometry3d place =
        std::dynamic_pointer_cast<const CameraSensor>(first.sensor)->place(first.nominal.sensor);
    const Isometry3d second_place = setup.is_on_flange ? place : place * beside;
    return with_sensor(
        first, sensor,
        sensor->unknowns({first.nominal.sensor, second->unknowns(second_place, setup.intrinsics)},
                         {Isometry3d::Identity(), beside}));
}

/// A fisheye on the flange, of which some intrinsic parameters are known with a deviation.
inline CameraSetup doubtful_on_flange() {
    CameraSetup setup = camera_on_flange();
    setup.is_known = {true, true, true, true, true, false, true, true};
    setup.deviations = {2e-3, 2e-3, 4e-3, 0, 0.01, 0, 0, 0};
    return setup;
}

/// A tracker elsewhere, which sees one more target.
inline Campaign second_tracker(const Campaign& from) {
    Campaign campaign =
        with_sensor(from,
                    std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(1),
                                                  LaserTrackerNoise{1e-5, 4e-5}),
                    Vector3d(0.22, -0.07, -0.09));
    campaign.nominal.world_from_base = Eigen::Translation3d(-1.5, 2.0, 0.3) *
                                       Eigen::AngleAxisd(1.9, Vector3d(-1, 2, 1).normalized());
    return campaign;
}

/// Three known planes about the robot, in a frame of their own, touched by one tip.
inline Campaign touched_planes(const Campaign& from) {
    std::vector<Plane> planes{{{0, 0, 1}, -0.4}, {{1, 0.1, 0}, 3}, {{0.2, 1, -0.3}, -1.5}};
    for (Plane& plane : planes) plane.normal_is_known = plane.offset_is_known = true;
    const Targets tip(std::vector<std::optional<Vector3d>>{std::nullopt});
    Campaign campaign = with_sensor(from, std::make_shared<PlaneSensor>(tip, planes, 5e-5),
                                    Vector3d(0.25, 0.03, 0.08));
    campaign.nominal.world_from_base = Eigen::Translation3d(0.3, -0.2, 0.1) *
                                       Eigen::AngleAxisd(-0.6, Vector3d(1, -1, 2).normalized());
    return campaign;
}

inline std::vector<SensorCampaign> combined_campaigns(const Chain& robot) {
    const Campaign points = tracked_campaign(robot);
    const Campaign camera = before_camera(points, fixed_camera());
    CameraSetup on_flange = camera_on_flange();
    on_flange.growth = {1, 2.8, 3e-3};
    Isometry3d tool(Eigen::AngleAxisd(2.5, Vector3d(1, -2, 0.5).normalized()));
    tool.translation() = Vector3d(0.1, -0.05, 0.2);
    Campaign poses =
        with_sensor(points, std::make_shared<PoseSensor>(std::nullopt, IsotropicNoise{5e-5}, 1e-4),
                    tool_unknowns(tool));
    poses.nominal.world_from_base = second_tracker(points).nominal.world_from_base;
    return {{"two trackers", combined_campaign(points, {second_tracker(points)})},
            {"tracker and camera", combined_campaign(points, {camera})},
            {"tracker and planes", combined_campaign(points, {touched_planes(points)})},
            {"camera and planes, frame known",
             combined_campaign(before_camera(points, on_flange), {touched_planes(points)}, true)},
            {"poses and points", combined_campaign(poses, {points})},
            {"two boards before a camera on the flange", two_boards(points, camera_on_flange())},
            {"two boards on the flange", two_boards(points, fixed_camera())},
            {"two boards before a camera known with deviations",
             two_boards(points, doubtful_on_flange())},
            {"a fixed camera and one on the flange",
             combined_campaign(camera, {before_camera(points, camera_on_flange())})},
            {"tracker, camera roughly known and planes",
             combined_campaign(
                 points, {before_camera(points, camera_before_cube()), touched_planes(points)})}};
}

inline std::vector<SensorCampaign> campaigns_of_every_sensor(const Chain& robot) {
    const Campaign points = tracked_campaign(robot);
    const PointNoise tracker = LaserTrackerNoise{1e-5, 4e-5};
    Isometry3d tool(Eigen::AngleAxisd(2.5, Vector3d(1, -2, 0.5).normalized()));
    tool.translation() = Vector3d(0.1, -0.05, 0.2);
    const std::vector<Vector3d> two{{0.28, 0.05, -0.11}, {0.26, -0.09, 0.12}};
    const Targets partly(two, {{true, false, true}, {false, true, false}});
    const Targets unknown(std::vector<std::optional<Vector3d>>(2));
    VectorXd both(6);
    both << two[0], two[1];
    const std::vector<Vector3d> anchors{{1, 2, 0}, {-2, 1, 0.3}, {0.4, -2, 1}, {3, 0, 2}};
    VectorXd anchored(9);
    anchored << two[0], two[1], anchors[0];
    const std::vector<Plane> planes{{{0, 0, 1}, -0.4}, {{1, 0.1, 0}, 3}, {{0.2, 1, -0.3}, -1.5}};
    VectorXd on_planes = VectorXd::Zero(15);
    on_planes.head<6>() = both;
    for (Index k = 0; k < 3; ++k) {
        on_planes.segment<3>(6 + 3 * k) << 0.02, -0.01, planes[static_cast<std::size_t>(k)].offset;
    }
    std::vector<Plane> all_known = planes;
    for (Plane& plane : all_known) plane.normal_is_known = plane.offset_is_known = true;
    std::vector<Plane> partly_known = planes;
    partly_known[0].normal_is_known = true;
    partly_known[1].offset_is_known = true;
    VectorXd on_partly_known(12);
    on_partly_known << both, planes[0].offset, 0.02, -0.01, -0.03, 0.01, planes[2].offset;
    std::vector<Socket> sockets{{"s0"}, {"s1"}, {"s2", Vector3d::Zero(), 1, 0.3}};
    for (std::size_t k = 0; k < sockets.size(); ++k) {
        const double turn = 0.2 + 0.1 * static_cast<double>(k);
        sockets[k].position = points.nominal.world_from_base *
                              (robot.base_from_flange(VectorXd::Constant(6, turn),
                                                      VectorXd::Zero(robot.parameter_count())) *
                               two[0]);
    }
    const Targets ball(std::vector<std::optional<Vector3d>>{std::nullopt});
    VectorXd in_sockets(11);
    in_sockets << two[0], sockets[0].position, sockets[1].position, 0.1, -0.05;
    const auto pose = [&](std::optional<Isometry3d> known, const PointNoise& noise) {
        return std::make_shared<PoseSensor>(known, noise, 1e-4);
    };
    std::vector<SensorCampaign> all{
        {"points", points},
        {"points, partly known", with_sensor(points, std::make_shared<PointSensor>(partly, tracker),
                                             Vector3d(0.05, 0.26, 0.12))},
        {"pose of an unknown tool",
         with_sensor(points, pose(std::nullopt, IsotropicNoise{5e-5}), tool_unknowns(tool))},
        {"pose of a known tool", with_sensor(points, pose(tool, tracker), VectorXd())},
        {"pose from a camera on the flange",
         with_sensor(
             points,
             std::make_shared<PoseSensor>(std::nullopt, PerAxisNoise{Vector3d(2e-5, 3e-5, 9e-5)},
                                          1e-4, PoseRecord{true, true}),
             tool_unknowns(tool))},
        {"distances from known anchors",
         with_sensor(points, std::make_shared<DistanceSensor>(unknown, anchors, true, 5e-5), both)},
        {"distances from an unknown anchor",
         with_sensor(points,
                     std::make_shared<DistanceSensor>(unknown, std::vector<Vector3d>{anchors[0]},
                                                      false, 5e-5),
                     anchored, true)},
        {"known planes",
         with_sensor(points, std::make_shared<PlaneSensor>(unknown, all_known, 5e-5), both)},
        {"unknown planes", with_sensor(points, std::make_shared<PlaneSensor>(unknown, planes, 5e-5),
                                       on_planes, true)},
        {"planes known in part",
         with_sensor(points, std::make_shared<PlaneSensor>(unknown, partly_known, 5e-5),
                     on_partly_known, true)},
        {"known sockets",
         with_sensor(points, std::make_shared<SocketSensor>(ball, sockets, true, 5e-5), two[0])},
        {"unknown sockets",
         with_sensor(points, std::make_shared<SocketSensor>(ball, sockets, false, 5e-5), in_sockets,
                     true)}};
    Campaign base_partly_known = points;
    base_partly_known.base_is_known = {false, false, true, true, true, false};
    all.push_back({"points, base partly known", base_partly_known});
    all.push_back({"camera that is fixed", before_camera(points, fixed_camera())});
    all.push_back(
        {"camera on the flange, intrinsics unknown", before_camera(points, camera_on_flange())});
    all.push_back({"three fixed cameras", before_camera(points, three_cameras())});
    CameraSetup two_on_flange = camera_on_flange();
    two_on_flange.others = {two_on_flange};
    all.push_back({"two cameras on the flange", before_camera(points, two_on_flange)});
    all.push_back(
        {"camera before markers known roughly", before_camera(points, camera_before_cube())});
    all.push_back({"camera whose intrinsics are known with deviations",
                   before_camera(points, roughly_known_camera())});
    all.push_back(
        {"cameras whose noise grows with the pose", before_camera(points, cameras_with_focus())});
    CameraSetup focused_on_flange = camera_on_flange();
    focused_on_flange.growth = {1, 2.8, 3e-3};
    all.push_back({"camera on the flange whose noise grows with the pose",
                   before_camera(points, focused_on_flange)});
    for (SensorCampaign& several : combined_campaigns(robot)) all.push_back(std::move(several));
    return all;
}

}  // namespace posewise::testing
