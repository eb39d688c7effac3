#include "posewise/io/camera_places.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "core/text.hpp"
#include "io/format/atomic_file.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"

namespace posewise::io {
namespace {

using namespace detail;

constexpr const char* camera_frame = "camera_optical_frame";
constexpr const char* board_frame = "calibration_board";

/// Digits to read the number back, never "-0".
std::string plain(double number) { return fmt::format("{}", number + 0.0); }

std::string list_plainly(const std::vector<double>& numbers, const char* separator) {
    std::vector<std::string> words;
    for (const double number : numbers) words.push_back(plain(number));
    return fmt::format("{}", fmt::join(words, separator));
}

std::string opencv_matrix(const std::string& name, const RowMatrixXd& matrix) {
    const std::vector<double> numbers(matrix.data(), matrix.data() + matrix.size());
    return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
                       name, matrix.rows(), matrix.cols(), list_plainly(numbers, ",\n       "));
}

std::string opencv_text(const CameraPlaces& places, const std::string& title) {
    std::string text = fmt::format("%YAML:1.0\n---\n# {}; frames in m\n", escape_controls(title));
    if (places.image) {
        text += fmt::format("image_width: {:g}\nimage_height: {:g}\n", places.image->x(),
                            places.image->y());
    }
    if (places.intrinsics) {
        const Intrinsics& camera = *places.intrinsics;
        RowMatrixXd K(3, 3);
        K << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
        const bool is_fisheye = camera.distortion == Distortion::Fisheye;
        text += opencv_matrix("camera_matrix", K);
        text += fmt::format("distortion_model: {}\n", is_fisheye ? "fisheye" : "plumb_bob");
        std::vector<double> coefficients = camera.coefficients;
        if (coefficients.empty()) coefficients.assign(5, 0);
        text += opencv_matrix(
            "distortion_coefficients",
            Eigen::Map<const RowMatrixXd>(coefficients.data(), 1, std::ssize(coefficients)));
    }
    text += opencv_matrix(places.is_on_flange ? "flange_from_camera" : "base_from_camera",
                          places.camera.matrix());
    return text + opencv_matrix(places.is_on_flange ? "base_from_board" : "flange_from_board",
                                places.board.matrix());
}

std::string joint_text(const std::string& parent, const std::string& child,
                       const Isometry3d& parent_from_child) {
    const Vector3d xyz = parent_from_child.translation();
    const Vector3d rpy = rpy_from_rotation(parent_from_child.linear());
    return fmt::format(
        "  <link name=\"{1}\"/>\n"
        "  <joint name=\"{0}_to_{1}\" type=\"fixed\">\n"
        "    <parent link=\"{0}\"/>\n"
        "    <child link=\"{1}\"/>\n"
        "    <origin xyz=\"{2}\" rpy=\"{3}\"/>\n"
        "  </joint>\n",
        parent, child, list_plainly({xyz.x(), xyz.y(), xyz.z()}, " "),
        list_plainly({rpy.x(), rpy.y(), rpy.z()}, " "));
}

std::string urdf_text(const CameraPlaces& places, const CampaignFile& file) {
    const std::string flange = file.urdf ? file.urdf->tip_link : "tool0";
    const std::string base = file.urdf ? file.urdf->base_link : "base_link";
    const std::string& of_camera = places.is_on_flange ? flange : base;
    const std::string& of_board = places.is_on_flange ? base : flange;
    std::string text = fmt::format("<robot name=\"camera\">\n  <link name=\"{}\"/>\n", of_camera);
    text += joint_text(of_camera, camera_frame, places.camera);
    text += fmt::format("  <link name=\"{}\"/>\n", of_board);
    return text + joint_text(of_board, board_frame, places.board) + "</robot>\n";
}

bool has_ending(const std::string& path, const std::vector<std::string>& endings) {
    const std::string ending = std::filesystem::path(path).extension().string();
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}
bool is_yaml(const std::string& path) { return has_ending(path, {".yaml", ".yml"}); }

}  // namespace

std::optional<CameraPlaces> camera_places(const Campaign& campaign, const Parameters& found) {
    const Isometry3d base_from_world = found.world_from_base.inverse();
    const auto with = [&](bool is_on_flange, const Isometry3d& on_flange) {
        return is_on_flange ? CameraPlaces{true, on_flange, base_from_world, {}, {}}
                            : CameraPlaces{false, base_from_world, on_flange, {}, {}};
    };
    if (const auto* const poses = dynamic_cast<const PoseSensor*>(campaign.sensor.get())) {
        return with(poses->record().is_made_at_body, poses->tool(found.sensor));
    }
    const auto* const camera = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    if (camera == nullptr) return std::nullopt;
    auto places =
        std::make_optional(with(camera->setup().is_on_flange, camera->place(found.sensor)));
    places->intrinsics = camera->intrinsics(found.sensor);
    places->image = camera->setup().view.image;
    return places;
}

void check_camera_path(const std::string& path) {
    if (is_yaml(path) || has_ending(path, {".urdf", ".xacro"})) return;
    throw input_error_at({path},
                         "must end in .yaml (a file of OpenCV's) or .urdf (fixed joints), which "
                         "says what is written");
}

void write_camera(const std::string& path, const CampaignFile& file, const CameraPlaces& places) {
    check_camera_path(path);
    if (!is_yaml(path)) return write_file(path, urdf_text(places, file));
    write_file(path, opencv_text(places, file.name + ", calibrated"));
}

std::string static_transform(const CampaignFile& file, const CameraPlaces& places) {
    const std::string flange = file.urdf ? file.urdf->tip_link : "tool0";
    const std::string base = file.urdf ? file.urdf->base_link : "base_link";
    const Vector3d p = places.camera.translation();
    const Eigen::Quaterniond q(places.camera.linear());
    return fmt::format(
        "static_transform_publisher --x {} --y {} --z {} --qx {} --qy {} --qz {} --qw {} "
        "--frame-id {} --child-frame-id {}",
        plain(p.x()), plain(p.y()), plain(p.z()), plain(q.x()), plain(q.y()), plain(q.z()),
        plain(q.w()), places.is_on_flange ? flange : base, camera_frame);
}

}  // namespace posewise::io
