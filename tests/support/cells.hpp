#pragma once

#include <memory>

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/cell.hpp"
#include "support/robots.hpp"

/// The cell of designs/cell_demo/campaign.yaml in code.
namespace posewise::testing {

/// The FANUC robot and a tracker 4.5 m in front of it that looks back at it, with three reflectors.
inline Campaign cell_campaign() {
    const auto deg = degree;
    Campaign campaign;
    campaign.name = "cell";
    const double limits[6][2] = {{-90, 90},   {-50, 60},   {-80, 60},
                                 {-180, 180}, {-110, 110}, {-180, 180}};
    std::vector<Joint> joints = fanuc().joints();
    for (std::size_t j = 0; j < 6; ++j) {
        joints[j].lower = limits[j][0] * deg;
        joints[j].upper = limits[j][1] * deg;
    }
    campaign.robot = Chain(joints, fanuc().elements());
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), 5e-5);
    campaign.nominal.world_from_base =
        Eigen::Translation3d(4.5, -1.5, -0.6) * Eigen::AngleAxisd(180 * deg, Vector3d::UnitZ());
    campaign.nominal.robot = VectorXd::Zero(campaign.robot.parameter_count());
    campaign.nominal.sensor.resize(9);
    campaign.nominal.sensor << 0.25, 0, 0.12, 0.25, 0.105, -0.06, 0.25, -0.105, -0.06;
    campaign.has_nominal_base = true;
    campaign.has_nominal_targets = true;
    return campaign;
}

inline Cell demo_cell() {
    const auto deg = degree;
    Cell cell;
    cell.limit_margin = {2 * deg, 0};
    cell.least_joint_distance = 5 * deg;
    cell.target_boxes = {{Vector3d(0.3, -2.2, -0.4), Vector3d(3.0, 1.8, 2.4)}};
    cell.links = {{"column", 0, {{0, 0, -0.67}, {0, 0, -0.35}, 0.25}},
                  {"shoulder", 1, {{0, 0, 0}, {0.312, 0, 0}, 0.22}},
                  {"upper arm", 2, {{0, 0, 0.2}, {0, 0, 0.975}, 0.16}},
                  {"forearm", 3, {{-0.1, 0, 0.225}, {0.9, 0, 0.225}, 0.17}},
                  {"wrist", 5, {{0, 0, 0}, {0.12, 0, 0}, 0.11}},
                  {"tool", 7, {{0.1, 0, 0}, {0.215, 0, 0}, 0.07}}};
    cell.keep_outs = {{"floor", HalfSpace{{0, 0, -0.67}, {0, 0, 1}}},
                      {"wall", HalfSpace{{0, 2.2, 0}, {0, -1, 0}}},
                      {"table", Box{{0.9, -0.6, -0.67}, {1.7, 0.6, -0.1}}},
                      {"fixture", Capsule{{1.3, 0, -0.1}, {1.3, 0, 0.15}, 0.12}},
                      {"tracker", Sphere{{4.5, -1.5, 0.6}, 0.6}}};
    cell.safety_distance = 0.02;
    Sight sight;
    sight.range = {1.5, 8};
    sight.azimuth = {-60 * deg, 30 * deg};
    sight.elevation = {-20 * deg, 45 * deg};
    sight.normals = {Vector3d(0.94, 0, 0.34).normalized(), Vector3d(0.94, 0.3, -0.17).normalized(),
                     Vector3d(0.94, -0.3, -0.17).normalized()};
    sight.acceptance_half_angle = 30 * deg;
    sight.least_visible = 1;
    cell.sight = sight;
    cell.home = VectorXd::Zero(6);
    cell.home[1] = -30 * deg;
    cell.speed.resize(6);
    cell.speed << 130, 115, 125, 180, 180, 260;
    cell.speed *= deg;
    return cell;
}

}  // namespace posewise::testing
