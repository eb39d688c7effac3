#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/text.hpp"
#include "io/format/atomic_file.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"
#include "urdf_tree.hpp"

namespace posewise::io {
namespace {

using namespace detail;

constexpr const char* camera_frame = "camera_optical_frame";
constexpr const char* board_frame = "calibration_board";

std::string opencv_matrix(const std::string& name, const RowMatrixXd& matrix) {
    const RowMatrixXd numbers = matrix.array() + 0.0;  // never "-0"
    return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
                       name, matrix.rows(), matrix.cols(),
                       fmt::join(numbers.data(), numbers.data() + numbers.size(), ",\n       "));
}

/// `prefix`: "camera" writes camera_matrix, "camera2" camera2_matrix.
std::string intrinsics_text(const Intrinsics& camera, const std::string& prefix) {
    RowMatrixXd K(3, 3);
    K << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
    const bool is_fisheye = camera.distortion == Distortion::Fisheye;
    const std::string own = prefix == "camera" ? "" : prefix + '_';
    std::vector<double> coefficients = camera.coefficients;
    if (coefficients.empty()) coefficients.assign(5, 0);
    return opencv_matrix(prefix + "_matrix", K) +
           fmt::format("{}distortion_model: {}\n", own, is_fisheye ? "fisheye" : "plumb_bob") +
           opencv_matrix(
               own + "distortion_coefficients",
               Eigen::Map<const RowMatrixXd>(coefficients.data(), 1, std::ssize(coefficients)));
}

std::string image_text(const std::optional<Vector2d>& image, const std::string& own) {
    if (!image) return "";
    return fmt::format("{0}image_width: {1:g}\n{0}image_height: {2:g}\n", own, image->x(),
                       image->y());
}

/// "camera2" of the first further one.
std::string name_of_other(std::size_t k) { return fmt::format("camera{}", k + 2); }

std::string opencv_text(const CameraPlaces& places, const std::string& title) {
    std::string text = fmt::format("%YAML:1.0\n---\n# {}; frames in m\n", escape_controls(title));
    text += image_text(places.image, "");
    if (places.intrinsics) text += intrinsics_text(*places.intrinsics, "camera");
    for (std::size_t k = 0; k < places.others.size(); ++k) {
        const std::string name = name_of_other(k);
        text += image_text(places.others[k].image, name + '_');
        text += intrinsics_text(places.others[k].intrinsics, name);
        text += opencv_matrix("camera_from_" + name, places.others[k].in_first.matrix());
    }
    text += opencv_matrix(places.is_on_flange ? "flange_from_camera" : "base_from_camera",
                          places.camera.matrix());
    return text + opencv_matrix(places.is_on_flange ? "base_from_board" : "flange_from_board",
                                places.board.matrix());
}

std::string joint_text(const std::string& parent, const std::string& child,
                       const Isometry3d& parent_from_child) {
    return fmt::format(
        "  <link name=\"{1}\"/>\n"
        "  <joint name=\"{0}_to_{1}\" type=\"fixed\">\n"
        "    <parent link=\"{0}\"/>\n"
        "    <child link=\"{1}\"/>\n"
        "    <origin xyz=\"{2}\" rpy=\"{3}\"/>\n"
        "  </joint>\n",
        parent, child, vector_text(parent_from_child.translation()),
        vector_text(rpy_from_rotation(parent_from_child.linear())));
}

/// The link of the flange, or of the base.
std::string link_of(const CampaignFile& file, bool is_flange) {
    if (file.urdf) return is_flange ? file.urdf->tip_link : file.urdf->base_link;
    return is_flange ? "tool0" : "base_link";
}

std::string urdf_text(const CameraPlaces& places, const CampaignFile& file) {
    const std::string of_camera = link_of(file, places.is_on_flange);
    const std::string of_board = link_of(file, !places.is_on_flange);
    std::string text = fmt::format("<robot name=\"camera\">\n  <link name=\"{}\"/>\n", of_camera);
    text += joint_text(of_camera, camera_frame, places.camera);
    for (std::size_t k = 0; k < places.others.size(); ++k) {
        text += joint_text(camera_frame, name_of_other(k) + "_optical_frame",
                           places.others[k].in_first);
    }
    text += fmt::format("  <link name=\"{}\"/>\n", of_board);
    return text + joint_text(of_board, board_frame, places.board) + "</robot>\n";
}

bool is_yaml(const std::string& path) { return path.ends_with(".yaml") || path.ends_with(".yml"); }

}  // namespace

std::optional<CameraPlaces> camera_places(const Campaign& campaign, const Parameters& found) {
    if (const auto* several = dynamic_cast<const CombinedSensor*>(campaign.sensor.get())) {
        for (Index part = 0; part < several->part_count(); ++part) {
            Campaign one = campaign;
            one.sensor = several->part(part).sensor;
            if (auto places = camera_places(one, several->parameters_of(part, found))) {
                return places;
            }
        }
        return std::nullopt;
    }
    const Isometry3d base_from_world = found.world_from_base.inverse();
    const auto with = [&](bool is_on_flange, const Isometry3d& on_flange) {
        return is_on_flange ? CameraPlaces{true, on_flange, base_from_world, {}, {}, {}}
                            : CameraPlaces{false, base_from_world, on_flange, {}, {}, {}};
    };
    if (const auto* const poses = dynamic_cast<const PoseSensor*>(campaign.sensor.get())) {
        return with(poses->record().is_made_at_body, poses->tool(found.sensor));
    }
    const auto* const camera = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    if (camera == nullptr) return std::nullopt;
    auto places =
        std::make_optional(with(camera->setup().is_on_flange, camera->place(found.sensor)));
    places->intrinsics = camera->intrinsics(found.sensor);
    places->image = camera->setup().image;
    places->others = camera->placed_others(found.sensor);
    return places;
}

void check_camera_path(const std::string& path) {
    if (is_yaml(path) || path.ends_with(".urdf") || path.ends_with(".xacro")) return;
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
    const Vector3d p = places.camera.translation().array() + 0.0;  // never "-0"
    Eigen::Quaterniond q(places.camera.linear());
    q.coeffs().array() += 0.0;
    return fmt::format(
        "static_transform_publisher --x {} --y {} --z {} --qx {} --qy {} --qz {} --qw {} "
        "--frame-id {} --child-frame-id {}",
        p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w(), link_of(file, places.is_on_flange),
        camera_frame);
}

}  // namespace posewise::io
