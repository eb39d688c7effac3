#include "camera_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "io/format/atomic_file.hpp"
#include "io/format/text.hpp"

namespace posewise::detail {
namespace {

YamlValue require(const YamlValue& map, std::string_view key) {
    return require_of(map, key, "which a camera needs");
}

/// A list of numbers, or an OpenCV matrix: a map with `data`.
std::vector<double> numbers_of(const YamlValue& value) {
    const YamlValue list = value.is_map() ? require(value, "data") : value;
    std::vector<double> numbers;
    for (const YamlValue& item : list.list()) {
        if (!item.is_list()) {
            numbers.push_back(item.number());
            continue;
        }
        for (const YamlValue& inner : item.list()) numbers.push_back(inner.number());
    }
    return numbers;
}

/// Trailing zeros beyond a model's numbers go; others are refused.
void set_coefficients(const YamlValue& value, std::vector<double> numbers, bool is_fisheye,
                      Intrinsics& intrinsics) {
    intrinsics.distortion = is_fisheye ? Distortion::Fisheye : Distortion::BrownConrady;
    const std::size_t most = is_fisheye ? 4 : 8;
    while (numbers.size() > most && numbers.back() == 0) numbers.pop_back();
    const std::size_t count = numbers.size();
    if (count == 0) {
        intrinsics.distortion = Distortion::None;
    } else if (count > most || (is_fisheye ? count != 4 : count != 4 && count != 5 && count != 8)) {
        throw value.error(fmt::format("has {} coefficients; must have {}", count,
                                      is_fisheye ? "4"
                                                 : "4, 5 or 8 (of a thin prism or a tilted "
                                                   "sensor there are none here)"));
    }
    intrinsics.coefficients = std::move(numbers);
}

/// `own`: what stands before the words of this camera, "camera2_"; nothing of the first.
CameraFile read_opencv(const YamlValue& file, const std::string& own) {
    CameraFile camera;
    const YamlValue matrix = require(file, own.empty() ? "camera_matrix" : own + "matrix");
    const std::vector<double> K = numbers_of(matrix);
    if (K.size() != 9) throw matrix.error("must have 9 numbers, row by row");
    constexpr double none = 1e-9;
    if (std::abs(K[1]) > none * std::abs(K[0]) || std::abs(K[8] - 1) > none) {
        throw matrix.error("has skew or a last number other than 1; must be fx 0 cx 0 fy cy 0 0 1");
    }
    camera.intrinsics = {K[0], K[4], K[2], K[5], Distortion::None, {}};
    std::optional<YamlValue> coefficients;
    for (const char* const key :
         {"distortion_coefficients", "distortion_coeffs", "dist_coeffs", "dist_coeff"}) {
        if (!coefficients) coefficients = find_of(file, own + key);
    }
    if (!coefficients) {
        throw file.error(
            "has a camera_matrix and no distortion_coefficients, as if it were cut off; must have "
            "them, 0 for a lens without distortion");
    }
    const auto model = find_of(file, own + "distortion_model");
    const bool is_fisheye = model && (model->is_text("fisheye") || model->is_text("equidistant"));
    set_coefficients(*coefficients, numbers_of(*coefficients), is_fisheye, camera.intrinsics);
    const auto width = find_of(file, own + "image_width"),
               height = find_of(file, own + "image_height");
    if (width && height) camera.image = Vector2d(width->number(), height->number());
    return camera;
}

CameraFile read_kalibr(const YamlValue& cam) {
    if (const auto model = find_of(cam, "camera_model"); model && !model->is_text("pinhole")) {
        throw model->error("is " + quote(model->text()) + "; must be pinhole");
    }
    CameraFile camera;
    const YamlValue intrinsics = require(cam, "intrinsics");
    const std::vector<double> f = numbers_of(intrinsics);
    if (f.size() != 4) throw intrinsics.error("must have 4 numbers: fx, fy, cx, cy");
    camera.intrinsics = {f[0], f[1], f[2], f[3], Distortion::None, {}};
    const auto model = find_of(cam, "distortion_model");
    if (model && !model->is_text("none")) {
        const bool is_fisheye = model->is_text("equidistant");
        if (!is_fisheye && !model->is_text("radtan")) {
            throw model->error("is " + quote(model->text()) +
                               "; must be radtan, equidistant or none");
        }
        const YamlValue value = require(cam, "distortion_coeffs");
        set_coefficients(value, numbers_of(value), is_fisheye, camera.intrinsics);
    }
    if (const auto size = find_of(cam, "resolution")) {
        const std::vector<double> px = size->numbers(2);
        camera.image = Vector2d(px[0], px[1]);
    }
    return camera;
}

/// OpenCV begins with "%YAML:1.0", which is no YAML, and may name its matrices' type.
std::string without_opencv_words(std::string content) {
    if (content.starts_with("%YAML:")) content.replace(0, 1, "#");
    constexpr std::string_view type = "!!opencv-matrix";
    for (auto at = content.find(type); at != std::string::npos; at = content.find(type, at)) {
        content.replace(at, type.size(), std::string(type.size(), ' '));
    }
    return content;
}

/// Nothing but comments, ends and beginnings of YAML's documents, and blanks.
bool is_blank(const std::string& content) {
    std::istringstream lines(content);
    for (std::string line; std::getline(lines, line);) {
        const auto text = trim(line);
        const bool is_mark = text.starts_with('#') || text.starts_with('%') || text == "---" ||
                             text == "..." || text == "\xEF\xBB\xBF";
        if (!text.empty() && !is_mark) return false;
    }
    return true;
}

}  // namespace

NamedFile read_named_file(const YamlValue& asked_by) {
    const std::filesystem::path campaign(asked_by.location().path);
    const std::filesystem::path path = campaign.parent_path() / asked_by.text();
    std::error_code error;
    if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error)) {
        throw asked_by.error(
            fmt::format("cannot be read: {} is no regular file; must be a file", path.string()));
    }
    NamedFile file{path.string(), {}};
    try {
        file.content = read_file(path.string());
    } catch (const InputError& e) {
        throw asked_by.error(fmt::format("cannot be read: {}", e.what()));
    }
    if (is_blank(file.content)) {
        throw asked_by.error(fmt::format(
            "cannot be used: {} is empty; must describe what it is named for", file.path));
    }
    return file;
}

YamlValue parse_opencv_yaml(NamedFile file) {
    return parse_yaml(without_opencv_words(std::move(file.content)), file.path);
}

CameraFile read_camera_file(const YamlValue& asked_by, Index camera) {
    const YamlValue file = parse_opencv_yaml(read_named_file(asked_by));
    // A file may hold one camera or several.
    const auto kalibr = find_of(file, fmt::format("cam{}", camera));
    const auto only = find_of(file, "cam0");
    const std::string own = camera == 0 ? "" : fmt::format("camera{}_", camera + 1);
    const bool has_own = find_of(file, own + "matrix").has_value();
    CameraFile found = kalibr ? read_kalibr(*kalibr)
                       : only ? read_kalibr(*only)
                              : read_opencv(file, has_own ? own : "");
    try {
        check_intrinsics(found.intrinsics);
    } catch (const InputError& e) {
        throw file.error(e.what());
    }
    return found;
}

}  // namespace posewise::detail
