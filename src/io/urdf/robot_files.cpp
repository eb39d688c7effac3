#include "posewise/io/robot_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/checksum.hpp"
#include "core/text.hpp"
#include "io/campaign/robot_parts.hpp"
#include "io/format/atomic_file.hpp"
#include "io/format/yaml_reader.hpp"
#include "mujoco_model.hpp"
#include "posewise/model/chain.hpp"
#include "robodk_model.hpp"
#include "urdf_tree.hpp"

namespace posewise::io {
namespace {

using namespace detail;

const std::vector<std::string> ur_links{"shoulder", "upper_arm", "forearm",
                                        "wrist_1",  "wrist_2",   "wrist_3"};
const std::vector<std::string> ur_numbers{"x", "y", "z", "roll", "pitch", "yaw"};

/// By how much a file's flange may differ from the robot's: m, rad.
struct Tolerance {
    double position = 1e-9;
    double orientation = 1e-9;
};

/// Writes the text if `read` makes the same robot of its file.
template <class Read>
FlangeDifference write_robot(const std::string& path, const std::string& text, const Chain& robot,
                             const VectorXd& errors, const Read& read,
                             const Tolerance& tolerance = Tolerance()) {
    FlangeDifference difference;
    write_file(path, text, [&](const std::string& written) {
        difference = compare_flanges(robot, errors, read(written), VectorXd());
        if (difference.position <= tolerance.position &&
            difference.orientation <= tolerance.orientation) {
            return;
        }
        throw input_error_at(
            {path},
            fmt::format("is not written: read back, its flange is up to {:.1e} m and {:.1e} "
                        "rad from the estimate's; must be within {:.0e} m and {:.0e} rad",
                        difference.position, difference.orientation, tolerance.position,
                        tolerance.orientation));
    });
    return difference;
}

/// The errors without those of terms and those of these names.
VectorXd without(const Chain& robot, VectorXd errors, const std::vector<std::string>& names) {
    const std::vector<std::string> all = robot.parameter_names();
    for (Index k = 0; k < robot.parameter_count(); ++k) {
        const auto& name = all[static_cast<std::size_t>(k)];
        const bool is_named = std::find(names.begin(), names.end(), name) != names.end();
        if (is_named || robot.parameter_term(k) != nullptr) errors[k] = 0;
    }
    return errors;
}

Chain read_dh_robot(const std::string& path) {
    const YamlMap file(parse_yaml(read_file(path), path), std::vector<std::string>{"robot"});
    return read_robot(file.require("robot"), ErrorModel::Stated).declared;
}

std::string ur_text(const std::string& title, const UrFrames& frames) {
    std::string text = fmt::format("# {}\nkinematics:\n", title);
    Checksum checksum;
    for (std::size_t k = 0; k < frames.size(); ++k) {
        const Vector3d xyz = frames[k].translation();
        const Vector3d rpy = rpy_from_rotation(frames[k].linear());
        checksum.add(RowMatrixXd(xyz));
        checksum.add(RowMatrixXd(rpy));
        const auto plain = [](double number) { return number + 0.0; };  // never "-0"
        fmt::format_to(std::back_inserter(text),
                       "  {}:\n    x: {}\n    y: {}\n    z: {}\n    roll: {}\n    pitch: {}\n"
                       "    yaw: {}\n",
                       ur_links[k], plain(xyz.x()), plain(xyz.y()), plain(xyz.z()), plain(rpy.x()),
                       plain(rpy.y()), plain(rpy.z()));
    }
    const std::string sum = checksum.text();
    return text + "  hash: posewise_" + sum.substr(sum.find(':') + 1) + '\n';
}

}  // namespace

FlangeDifference write_calibrated_urdf(const std::string& path, const CalibratedUrdf& urdf,
                                       const UrdfSource& source, const Chain& robot,
                                       const VectorXd& errors) {
    return write_robot(path, urdf.text, robot, without(robot, errors, urdf.not_expressed),
                       [&](const std::string& written) {
                           return make_chain_without_limits(
                               read_urdf({written, source.base_link, source.tip_link}));
                       });
}

FlangeDifference write_dh(const std::string& path, const std::string& title,
                          const std::vector<DhRow>& rows, const Chain& robot,
                          const VectorXd& errors) {
    const std::string text =
        fmt::format("# {}\n", escape_controls(title)) + make_dh_text(robot, rows);
    return write_robot(path, text, robot, without(robot, errors, {}), read_dh_robot);
}

FlangeDifference write_ur_kinematics(const std::string& path, const std::string& title,
                                     const UrFrames& frames, const Chain& robot,
                                     const VectorXd& errors) {
    const auto read = [&](const std::string& written) {
        return ur_chain(read_ur_kinematics(written), robot.joints());
    };
    return write_robot(path, ur_text(escape_controls(title), frames), without_half_turn(robot),
                       without(robot, errors, {}), read,
                       {ur_rounding.position + 1e-9, ur_rounding.orientation + 1e-9});
}

FlangeDifference write_mujoco(const std::string& path, const std::string& title,
                              const Geometry& geometry) {
    const Chain& robot = geometry.robot;
    return write_robot(path, mujoco_text(escape_controls(title), geometry), robot,
                       without(robot, geometry.errors, {}), [&](const std::string& written) {
                           return read_mujoco(written, robot.joints());
                       });
}

FlangeDifference write_robodk(const std::string& path, const std::string& title,
                              const ModifiedDh& table, const Chain& robot, const VectorXd& errors) {
    return write_robot(
        path, robodk_text(escape_controls(title), table), robot, without(robot, errors, {}),
        [&](const std::string& written) { return read_robodk(written, robot.joints()); });
}

UrFrames read_ur_kinematics(const std::string& path) {
    const std::vector<std::string> top{"kinematics"};
    std::vector<std::string> all = ur_links;
    all.emplace_back("hash");
    const YamlMap file(parse_yaml(read_file(path), path), top);
    const YamlMap links(file.require("kinematics"), all);
    UrFrames frames;
    for (std::size_t k = 0; k < frames.size(); ++k) {
        const YamlMap link(links.require(ur_links[k]), ur_numbers);
        const auto number = [&](std::size_t i) { return link.require(ur_numbers[i]).number(); };
        frames[k].setIdentity();
        frames[k].translation() = Vector3d(number(0), number(1), number(2));
        frames[k].linear() = rotation_from_rpy(Vector3d(number(3), number(4), number(5)));
    }
    return frames;
}

}  // namespace posewise::io
