#include <algorithm>
#include <cmath>
#include <cstdint>

#include "io/format/atomic_file.hpp"
#include "io/format/json.hpp"
#include "page_template.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/measurement/camera_sensor.hpp"

namespace posewise::io {
namespace {

using detail::Json;

/// Numbers that are drawn need not be read back exactly, and less text loads faster.
double rounded(double value, double per_unit) { return std::round(per_unit * value) / per_unit; }

/// To um and urad; of mm to the nm.
double to_micro(double value) { return rounded(value, 1e6); }

Json drawn(const Eigen::Ref<const VectorXd>& values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(to_micro(value));
    return list;
}

Json pose_to_json(const Isometry3d& pose) {
    Json list = Json::array();
    for (Index row = 0; row < 4; ++row) {
        for (Index column = 0; column < 4; ++column) list.push_back(pose.matrix()(row, column));
    }
    return list;
}

// ---- The scene ----

Json chain_joint_to_json(const Joint& joint) {
    return {{"name", joint.name},
            {"kind", joint.motion == Motion::Rotation ? "revolute" : "prismatic"},
            {"lower", joint.lower},
            {"upper", joint.upper}};
}

Json chain_element_to_json(const Element& element) {
    Json joints = Json::array();
    for (const JointTerm& term : element.joints) {
        joints.push_back({{"joint", term.joint}, {"coefficient", term.coefficient}});
    }
    return {{"motion", transform_name(element)},
            {"amount", element.value},
            {"joints", std::move(joints)}};
}

Json capsule_to_json(const SceneCapsule& capsule) {
    return {{"name", capsule.name},
            {"kind", capsule.is_obstacle ? "keep_out" : "link"},
            {"after_element", capsule.after_element},
            {"from", detail::vector_to_json(capsule.solid.from)},
            {"to", detail::vector_to_json(capsule.solid.to)},
            {"radius", capsule.solid.radius}};
}

Json box_to_json(const SceneBox& box) {
    return {{"name", box.name},
            {"kind", box.is_obstacle ? "keep_out" : "targets"},
            {"world_from_box", pose_to_json(box.world_from_box)},
            {"size", drawn(box.size)}};
}

Json targets_to_json(const std::vector<SceneTarget>& targets) {
    Json names = Json::array();
    Json positions = Json::array();
    for (const SceneTarget& target : targets) {
        names.push_back(target.name);
        positions.push_back(detail::vector_to_json(target.position));
    }
    return {{"names", std::move(names)}, {"positions", std::move(positions)}};
}

/// Without the torques that were measured with them.
Json joints_to_json(const PagePart& part, const VectorXd& configuration) {
    return drawn(part.scene ? configuration.head(part.scene->robot.joint_count()).eval()
                            : configuration);
}

Json views_to_json(const SceneViews& views) {
    Json json = {{"on_flange", views.is_camera_on_flange ? "camera" : "board"},
                 {"flange_from_it", pose_to_json(views.flange_from_it)},
                 {"cameras", Json::array()},
                 {"corners", Json::array()}};
    for (const SceneCamera& camera : views.cameras) {
        json["cameras"].push_back({{"in_first", pose_to_json(camera.in_first)},
                                   {"window", drawn(Eigen::Vector4d(camera.window.data()))}});
    }
    for (const Vector3d& corner : views.corners) json["corners"].push_back(drawn(corner));
    return json;
}

Json scene_to_json(const PagePart& part) {
    const Scene& scene = *part.scene;
    Json json = {{"joints", Json::array()},
                 {"elements", Json::array()},
                 {"world_from_base", pose_to_json(scene.world_from_base)},
                 {"targets", targets_to_json(scene.targets)},
                 {"capsules", Json::array()},
                 {"boxes", Json::array()},
                 {"walls", Json::array()}};
    for (const Joint& joint : scene.robot.joints()) {
        json["joints"].push_back(chain_joint_to_json(joint));
    }
    for (const Element& element : scene.robot.elements()) {
        json["elements"].push_back(chain_element_to_json(element));
    }
    for (const SceneCapsule& capsule : scene.capsules) {
        json["capsules"].push_back(capsule_to_json(capsule));
    }
    for (const SceneBox& box : scene.boxes) json["boxes"].push_back(box_to_json(box));
    for (const SceneWall& wall : scene.walls) {
        json["walls"].push_back(
            {{"name", wall.name}, {"point", drawn(wall.point)}, {"normal", drawn(wall.normal)}});
    }
    if (scene.floor_z) json["floor_z"] = *scene.floor_z;
    if (scene.instrument) {
        json["instrument"] = {{"kind", scene.instrument->kind},
                              {"position", drawn(scene.instrument->position)}};
    }
    if (scene.views) json["views"] = views_to_json(*scene.views);
    const RowMatrixXd& measured = part.configurations.joints;
    if (part.first_pose || measured.rows() > 0) {
        VectorXd first = part.first_pose ? *part.first_pose : measured.row(0).transpose();
        if (!part.first_pose) first = first.unaryExpr(&to_micro);  // as the page has it
        json["flange_of_first_pose"] = pose_to_json(world_from_flange(scene, first));
    }
    return json;
}

// ---- Configurations, residuals and errors ----

Json configurations_to_json(const PagePart& part, const PageConfigurations& measured) {
    Json joints = Json::array();
    for (Index i = 0; i < measured.joints.rows(); ++i) {
        joints.push_back(joints_to_json(part, measured.joints.row(i).transpose()));
    }
    return {{"id", measured.ids}, {"joints", std::move(joints)}};
}

/// Something of each reading.
Json column_of(const PageResiduals& residuals, auto value) {
    Json column = Json::array();
    for (const ReadingResidual& reading : residuals.readings) column.push_back(value(reading));
    return column;
}

/// A column of each axis, null where `find` has no vector.
Json columns_of(const PageResiduals& residuals, auto find, auto write) {
    Json columns = Json::array();
    for (Index axis = 0; axis < std::ssize(residuals.axes); ++axis) {
        columns.push_back(column_of(residuals, [&](const ReadingResidual& reading) -> Json {
            const VectorXd* const values = find(reading);
            if (values == nullptr) return nullptr;
            return write((*values)(axis));
        }));
    }
    return columns;
}

/// Whole nm and nrad are shorter than numbers with a point.
std::int64_t in_nm(double value) { return std::llround(1e9 * value); }
constexpr double px = 1e3;  // of pixel_units
double in_hundredths(double value) { return rounded(value, 1e2); }

Json directions_to_json(const PageResiduals& residuals, double Direction::*part) {
    return column_of(residuals, [&](const ReadingResidual& reading) -> Json {
        if (!reading.direction) return nullptr;
        return rounded((*reading.direction).*part, 1e5);
    });
}

/// Which camera each corner is seen by, from 0, and where.
void add_places(Json& readings, const PageResiduals& residuals) {
    if (residuals.images.empty()) return;
    readings["camera"] = Json::array();
    readings["place"] = {Json::array(), Json::array()};
    for (const PageCorner& corner : residuals.corners) {
        readings["camera"].push_back(corner.image);
        for (std::size_t axis = 0; axis < 2; ++axis) {
            readings["place"][axis].push_back(in_hundredths(corner.place[axis]));
        }
    }
}

Json readings_to_json(const PageResiduals& residuals) {
    using Reading = ReadingResidual;
    const Measurements& measured = residuals.measurements;
    Json json;
    json["configuration"] =
        column_of(residuals, [](const Reading& one) { return one.configuration; });
    json["sample"] = column_of(residuals, [&](const Reading& one) {
        const std::string& id = measured.ids[static_cast<std::size_t>(one.configuration)];
        const std::string name = measured.sample_name(one.configuration, one.sample);
        return name.substr(id.size() + 1);  // less "7:"
    });
    json["target"] = column_of(residuals, [](const Reading& one) { return one.target; });
    json["residual"] = columns_of(
        residuals, [](const Reading& one) { return &one.calibrated; }, in_nm);
    json["nominal"] = columns_of(
        residuals, [](const Reading& one) { return &one.nominal; }, in_nm);
    const auto find_held_out = [](const Reading& one) {
        return one.held_out ? &*one.held_out : nullptr;
    };
    const std::vector<Reading>& readings = residuals.readings;
    if (std::any_of(readings.begin(), readings.end(), find_held_out)) {
        json["held_out"] = columns_of(residuals, find_held_out, in_nm);
    }
    json["standardised"] = columns_of(
        residuals, [](const Reading& one) { return &one.standardised; }, in_hundredths);
    const auto has_direction = [](const Reading& one) { return one.direction.has_value(); };
    if (std::any_of(readings.begin(), readings.end(), has_direction)) {
        json["range"] = directions_to_json(residuals, &Direction::range);
        json["azimuth"] = directions_to_json(residuals, &Direction::azimuth);
        json["elevation"] = directions_to_json(residuals, &Direction::elevation);
    }
    add_places(json, residuals);
    return json;
}

Json image_to_json(const PageImage& image) {
    Json json = Json::object();
    if (!image.name.empty()) json["name"] = image.name;
    if (const auto& coverage = image.coverage) {
        json["size_px"] = coverage->size;
        json["columns"] = coverage->columns;
        json["counts"] = coverage->counts;
    }
    return json;
}

Json axes_to_json(const PageResiduals& residuals) {
    Json json = {{"axes", residuals.axes}, {"unit", Json::array()}, {"targets", residuals.names}};
    for (const AmountUnits* const units : residuals.units) json["unit"].push_back(units->error);
    for (const PageImage& image : residuals.images) {
        Json& one = json["images"].emplace_back(image_to_json(image));
        one["rms_px"] = image.rms;
    }
    return json;
}

Json expected_to_json(const PageResiduals& expected) {
    Json json = {{"images", Json::array()}, {"readings", Json::object()}};
    for (const PageImage& image : expected.images) json["images"].push_back(image_to_json(image));
    add_places(json["readings"], expected);
    return json;
}

/// Of readings that are only drawn: those of cameras, or of poses that were judged at.
Json other_residuals_to_json(const PageResiduals& others) {
    Json json = axes_to_json(others);
    Json& readings = json["readings"];
    readings["target"] = column_of(others, [](const ReadingResidual& one) { return one.target; });
    readings["residual"] = columns_of(
        others, [](const ReadingResidual& one) { return &one.calibrated; }, in_nm);
    add_places(readings, others);
    for (const PageResiduals& corners : others.of_cameras) {
        json["of_cameras"] = other_residuals_to_json(corners);
    }
    return json;
}

Json residuals_to_json(const PagePart& part) {
    const PageResiduals& residuals = *part.residuals;
    Json json = axes_to_json(residuals);
    json["readings"] = readings_to_json(residuals);
    for (const PageResiduals& corners : residuals.of_cameras) {
        json["of_cameras"] = other_residuals_to_json(corners);
    }
    for (const auto& [poses, others] : residuals.judged) {
        json[poses] = other_residuals_to_json(others);
        if (others.images.empty() || others.has_own_set_up) continue;
        const Measurements& measured = others.measurements;
        json[poses]["configurations"] =
            configurations_to_json(part, {measured.ids, measured.configurations});
        json[poses]["readings"]["configuration"] =
            column_of(others, [](const ReadingResidual& one) { return one.configuration; });
    }
    return json;
}

Json error_map_to_json(const ErrorMap& map) {
    Json json = {{"position", Json::array()}, {"predicted_mm", Json::array()}};
    for (const MappedError& error : map) {
        json["position"].push_back(drawn(error.position));
        json["predicted_mm"].push_back(to_micro(mm_per_m * error.predicted));
        if (error.displacement) {
            json["displacement_mm"].push_back(drawn(mm_per_m * *error.displacement));
        }
    }
    return json;
}

// ---- The page ----

/// Whatever a user typed, which need not be UTF-8.
Json typed_text(const std::optional<std::string>& text) {
    if (!text) return nullptr;
    return Json::parse(Json(*text).dump(-1, ' ', false, Json::error_handler_t::replace));
}

Json part_to_json(const PagePart& part) {
    Json json = {{"title", part.title},
                 {"command", typed_text(part.command)},
                 {"made_at", part.made_at},
                 {"printed", typed_text(part.printed)}};
    try {
        json["document"] = Json::parse(part.document);
    } catch (const Json::exception&) {
        throw input_error_at({part.title}, "is not JSON; must be a document of posewise");
    }
    if (part.scene) json["scene"] = scene_to_json(part);
    if (!part.configurations.ids.empty())
        json["configurations"] = configurations_to_json(part, part.configurations);
    if (part.residuals) json["residuals"] = residuals_to_json(part);
    if (part.expected) json["expected"] = expected_to_json(*part.expected);
    if (part.error_map) json["error_map"] = error_map_to_json(*part.error_map);
    return json;
}

/// Nothing in it can end a script or begin another; these stand in texts only.
std::string escape_for_script(const std::string& text) {
    std::string escaped;
    escaped.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        const std::string_view rest = std::string_view(text).substr(i, 3);
        if (text[i] == '<') {
            escaped += "\\u003c";
        } else if (text[i] == '>') {
            escaped += "\\u003e";
        } else if (text[i] == '&') {
            escaped += "\\u0026";
        } else if (rest == "\u2028" || rest == "\u2029") {
            escaped += rest == "\u2028" ? "\\u2028" : "\\u2029";
            i += 2;
        } else {
            escaped += text[i];
        }
    }
    return escaped;
}

/// The template with this document where its own is.
std::string fill_template(std::string_view page, const std::string& document) {
    constexpr std::string_view begin = R"(<script type="application/json" id="posewise">)";
    constexpr std::string_view end = "</script>";
    const std::size_t first = page.find(begin) + begin.size();
    const std::size_t last = page.find(end, first);
    std::string filled(page.substr(0, first));
    filled += document;
    return filled += page.substr(last);
}

Json page_to_json(const std::vector<PagePart>& parts) {
    Json document = detail::make_document("page");
    Json& list = document["parts"] = Json::array();
    for (const PagePart& part : parts) list.push_back(part_to_json(part));
    return document;
}

std::string make_page(const std::vector<PagePart>& parts, const std::vector<std::string>& warnings,
                      const std::string& place) {
    Json document = page_to_json(parts);
    document["warnings"] = warnings;
    const std::string text = detail::json_line(document, place);
    return fill_template(detail::page_template(), escape_for_script(text));
}

/// Of each target which image it is a corner in; -1: it is none.
std::vector<Index> image_of_targets(const std::vector<CameraImage>& images, Index targets) {
    std::vector<Index> image_of(static_cast<std::size_t>(targets), -1);
    for (Index k = 0; k < std::ssize(images); ++k) {
        for (const auto& [first, count] : images[static_cast<std::size_t>(k)].targets) {
            std::fill_n(image_of.begin() + first, count, k);
        }
    }
    return image_of;
}

/// Adds the images to residuals of corners.
void add_images(const Sensor& sensor, const std::vector<CameraImage>& cameras,
                PageResiduals& residuals) {
    const Measurements& measured = residuals.measurements;
    const std::vector<Index> image_of = image_of_targets(cameras, sensor.target_count());
    for (const CameraImage& camera : cameras) residuals.images.push_back({{}, 0, camera.name});
    std::size_t covered = 0;
    const std::vector<ImageCoverage> coverages = find_image_coverage(sensor, measured);
    for (std::size_t k = 0; k < cameras.size(); ++k) {
        if (cameras[k].size) residuals.images[k].coverage = coverages[covered++];
    }
    std::vector<Index> counts(cameras.size());
    for (const ReadingResidual& one : residuals.readings) {
        const Index image = image_of[static_cast<std::size_t>(one.target)];
        const Vector2d place =
            px * measured.observations.row(one.sample).segment<2>(sensor.first_row(one.target));
        residuals.corners.push_back({image, {place.x(), place.y()}});
        residuals.images[static_cast<std::size_t>(image)].rms += one.calibrated.squaredNorm();
        ++counts[static_cast<std::size_t>(image)];
    }
    for (std::size_t k = 0; k < counts.size(); ++k) {
        double& rms = residuals.images[k].rms;
        if (counts[k] > 0) rms = px * std::sqrt(rms / static_cast<double>(counts[k]));
    }
}

/// Of several sensors those readings that all have the same axes, and those of cameras.
void split_by_axes(const Sensor& sensor, const std::vector<CameraImage>& cameras,
                   PageResiduals& residuals) {
    const auto axes = static_cast<std::size_t>(sensor.has_lengths() ? sensor.lengths_per_target()
                                                                    : sensor.rows_per_target());
    residuals.axes.resize(axes);
    residuals.units.assign(axes, &sensor.main_units());
    const auto is_other = [&](const ReadingResidual& one) {
        return sensor.rows_of(one.target) != static_cast<Index>(axes) ||
               sensor.is_angle(sensor.first_row(one.target)) == sensor.has_lengths();
    };
    if (!cameras.empty() && sensor.has_lengths()) {
        PageResiduals corners = residuals;
        corners.axes = {"u", "v"};
        corners.units.assign(2, &pixel_units);
        const std::vector<Index> image_of = image_of_targets(cameras, sensor.target_count());
        std::erase_if(corners.readings, [&](const ReadingResidual& one) {
            return image_of[static_cast<std::size_t>(one.target)] < 0;
        });
        add_images(sensor, cameras, corners);
        residuals.of_cameras.push_back(std::move(corners));
    }
    std::erase_if(residuals.readings, is_other);
}

}  // namespace

PageResiduals page_residuals(const Campaign& campaign, const Measurements& measurements,
                             std::vector<ReadingResidual> readings) {
    PageResiduals residuals{residual_axes(campaign),
                            {},
                            reading_names(campaign),
                            measurements,
                            std::move(readings),
                            {},
                            {}};
    const Sensor& sensor = *campaign.sensor;
    const std::vector<CameraImage> cameras = camera_images(sensor);
    if (sensor.is_combined()) {
        split_by_axes(sensor, cameras, residuals);
    } else {
        for (Index row = 0; row < sensor.rows_per_target(); ++row) {
            residuals.units.push_back(&sensor.units(sensor.is_angle(row)));
        }
    }
    if (!cameras.empty() && !sensor.has_lengths()) add_images(sensor, cameras, residuals);
    return residuals;
}

std::optional<PageResiduals> page_expected(const Campaign& campaign, const Plan& plan) {
    if (camera_images(*campaign.sensor).empty()) return std::nullopt;
    const Measurements expected = expected_readings(campaign, plan);
    std::vector<ReadingResidual> readings;
    for (Index i = 0; i < expected.configuration_count(); ++i) {
        for (const Index target : targets_seen(expected.is_seen.row(i))) {
            ReadingResidual& one = readings.emplace_back();
            one.configuration = one.sample = i;
            one.target = target;
        }
    }
    PageResiduals shown = page_residuals(campaign, expected, std::move(readings));
    return shown.of_cameras.empty() ? shown : shown.of_cameras.front();
}

std::string to_json(const std::vector<PagePart>& parts) {
    return detail::json_text(page_to_json(parts));
}

std::string to_page(const std::vector<PagePart>& parts) { return make_page(parts, {}, "the page"); }

void write_page(const std::string& path, const std::vector<PagePart>& parts,
                const std::vector<std::string>& warnings) {
    detail::write_file(path, make_page(parts, warnings, path));
}

}  // namespace posewise::io
