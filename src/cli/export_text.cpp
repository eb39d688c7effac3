#include "export_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "common.hpp"
#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/model/chain.hpp"

namespace posewise::cli {
namespace {

std::string describe_position(const Vector3d& p) {
    return fmt::format("{} {} {}", detail::format_mm(p.x()), detail::format_mm(p.y()),
                       detail::format_mm(p.z()));
}

std::string describe_frame(const Isometry3d& frame) {
    const Vector3d rpy = rpy_from_rotation(frame.linear());
    return fmt::format(
        "position {} mm, roll pitch yaw {} {} {} deg", describe_position(frame.translation()),
        detail::format_fixed(to_degrees(rpy.x()), 5), detail::format_fixed(to_degrees(rpy.y()), 5),
        detail::format_fixed(to_degrees(rpy.z()), 5));
}

/// What no geometry can have, and what is lost with it.
void print_loss(const io::ExportedRobot& robot) {
    if (robot.terms.empty()) return;
    print(fmt::format("\nnot in the geometry, since they depend on the configuration: {}\n",
                      fmt::join(robot.terms, " ")));
    detail::Table table{{"geometry", "RMS/mm", "largest/mm"}, {}};
    const auto add = [&](const char* name, const PositionLoss& lost) {
        table.rows.push_back({name, detail::format_mm(lost.rms), detail::format_mm(lost.largest)});
    };
    add("not calibrated", robot.nominal);
    add("nearest", robot.nearest->lost);
    add("estimate", robot.estimated.lost);
    print_section("Lost without them, at the targets over the workspace", table);
    if (!robot.has_workspace) {
        print(
            "the workspace is all that limits (and cell) allow; --workspace says where the robot "
            "works\n");
    }
    print(robot.is_nearest ? "written is the nearest (--geometry estimate: the other)\n"
                           : "written is the estimate's (--geometry nearest: the other)\n");
}

/// What the sensor has on the flange.
std::string word_on_flange(const Campaign& campaign) {
    if (campaign.sensor->has_orientation()) return "tool";
    const auto* const camera = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    return camera == nullptr ? "targets" : camera->setup().on_flange();
}

void print_places(const Geometry& geometry, const Campaign& campaign, const std::string& base) {
    print(fmt::format("\nnot part of the robot: {} ({}), and the {} in the flange frame", base,
                      describe_frame(geometry.world_from_base), word_on_flange(campaign)));
    if (geometry.tool) return print(fmt::format(": {}\n", describe_frame(*geometry.tool)));
    const char* separator = ": ";
    for (const Vector3d& target : geometry.targets) {
        print(separator + describe_position(target));
        separator = "; ";
    }
    print(" mm\n");
}

detail::Table change_table(const io::CalibratedUrdf& urdf) {
    detail::Table table{{"joint", "moved by/mm", "turned by/mrad"}, {}};
    for (const io::OriginChange& change : urdf.changes) {
        table.rows.push_back({detail::escape_controls(change.joint),
                              detail::format_mm(change.translation),
                              detail::format_fixed(mrad_per_rad * change.rotation, 4)});
    }
    return table;
}

void print_urdf(const io::CalibratedUrdf& urdf, const io::CampaignFile& file,
                const std::string& path) {
    print(fmt::format("{}: {} with the origins of {} joints changed is in {}\n", file.name,
                      detail::escape_controls(file.urdf->path), urdf.changes.size(),
                      detail::escape_controls(path)));
    print_section("Origins", change_table(urdf));
    if (urdf.not_expressed.empty()) return;
    print(
        fmt::format("\nnot in the URDF: {} act behind the last joint, where no fixed joint is "
                    "that could take them\n",
                    fmt::join(urdf.not_expressed, " ")));
}

void print_dh(const std::vector<DhRow>& rows, const io::CampaignFile& file,
              const std::string& path) {
    print(
        fmt::format("{}: the calibrated robot in {} rows is in {}: RotZ(theta) TransZ(d) "
                    "TransX(a) RotX(alpha)\n",
                    file.name, rows.size(), detail::escape_controls(path)));
    std::vector<std::size_t> parallel;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (rows[k].beta != 0) parallel.push_back(k + 1);
    }
    if (parallel.empty()) return;
    print(
        fmt::format("{} {}: RotZ(theta) TransX(a) RotX(alpha) RotY(beta) (Hayati), since the "
                    "next axis is nearly parallel\n",
                    parallel.size() == 1 ? "row" : "rows", fmt::join(parallel, ", ")));
}

void print_frames(const io::CampaignFile& file, const std::string& path) {
    print(
        fmt::format("{}: the calibrated robot as kinematics of ur_description, from its "
                    "base_link_inertia to its tool0, is in {}\n",
                    file.name, detail::escape_controls(path)));
    const Chain& robot = file.declared_robot;
    if (without_half_turn(robot).elements().size() == robot.elements().size()) return;
    print("the half turn from base_link to base_link_inertia is not in it, as ROS has it itself\n");
}

void print_map(const CorrectionMap& map, const io::CampaignFile& file, const std::string& path) {
    print(fmt::format("{}: what depends on the configuration, in {} terms, is in {}\n", file.name,
                      map.terms.size(), detail::escape_controls(path)));
    detail::Table table{{"joints sent", "RMS/mm", "95 %/mm", "largest/mm", "RMS/mrad"}, {}};
    const auto add = [&](const char* name, const MapError& error) {
        table.rows.push_back({name, detail::format_mm(error.rms), detail::format_mm(error.p95),
                              detail::format_mm(error.largest),
                              detail::format_fixed(mrad_per_rad * error.orientation, 4)});
    };
    add("as the geometry has them", map.geometry_alone);
    add("with the map", map.with_map);
    print_section(fmt::format("Off the geometry at {} random configurations", map.pose_count),
                  table);
}

void print_camera(const io::CameraPlaces& places, const io::CampaignFile& file,
                  const std::string& path) {
    print(fmt::format("{}: camera and board{} are in {}\n", file.name,
                      places.intrinsics ? ", with the intrinsic parameters," : "",
                      detail::escape_controls(path)));
    print(fmt::format("\ncamera in the {} frame: {}\nROS 2: ros2 run tf2_ros {}\n",
                      places.is_on_flange ? "flange" : "base", describe_frame(places.camera),
                      io::static_transform(file, places)));
}

}  // namespace

void warn_of(const io::ExportedRobot& robot, const ExportPaths& paths) {
    constexpr double far = 10;  // m
    const auto warn = [](const std::string& path, const std::vector<DhRow>& rows) {
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const double offset = std::max(std::abs(rows[k].d), std::abs(rows[k].a));
            if (offset < far) continue;
            print_warning(fmt::format("{}: row {} has an offset of {} m; do not round it", path,
                                      k + 1, detail::format_short(offset, 4)));
        }
    };
    warn(paths.dh, robot.dh);
    if (robot.robodk) warn(paths.robodk, robot.robodk->rows);
}

void print_export(const io::ExportedRobot& robot, const io::CampaignFile& file,
                  const ExportPaths& paths) {
    if (robot.urdf) print_urdf(*robot.urdf, file, paths.urdf);
    if (!robot.dh.empty()) print_dh(robot.dh, file, paths.dh);
    if (robot.frames) print_frames(file, paths.ur_kinematics);
    if (!paths.mujoco.empty()) {
        print(fmt::format("{}: the calibrated robot as a model for MuJoCo is in {}\n", file.name,
                          detail::escape_controls(paths.mujoco)));
    }
    if (robot.robodk) {
        print(fmt::format("{}: the calibrated robot as parameters of RoboDK is in {}\n", file.name,
                          detail::escape_controls(paths.robodk)));
    }
    if (robot.map) print_map(*robot.map, file, paths.map);
    if (robot.camera) print_camera(*robot.camera, file, paths.camera);
    if (!paths.offsets.empty()) {
        print(fmt::format("{}: how far joints stand from where they are sent is in {}\n", file.name,
                          detail::escape_controls(paths.offsets)));
    }
    print_loss(robot);
    print_places(robot.written(), file,
                 file.urdf && robot.urdf
                     ? "where the instrument sees base link " + detail::quote(file.urdf->base_link)
                     : "where the instrument sees the base");
    for (const io::ReadBack& written : robot.read_back) {
        print(
            fmt::format("{} read back: the flange is within {:.1e} m and {:.1e} rad at {} "
                        "configurations\n",
                        detail::escape_controls(written.path), written.difference.position,
                        written.difference.orientation, written.difference.configuration_count));
    }
}

}  // namespace posewise::cli
