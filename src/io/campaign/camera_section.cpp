#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "board_section.hpp"
#include "camera_file.hpp"
#include "campaign_sections.hpp"
#include "io/format/text.hpp"
#include "keys.hpp"
#include "measurement/camera_model.hpp"
#include "measurement/camera_view.hpp"
#include "posewise/measurement/camera_sensor.hpp"

namespace posewise::detail {
namespace {

constexpr double px_per_kpx = 1e3;

/// A place where the file states none: forwards of the flange, on none of its axes.
Isometry3d generic_place() {
    Isometry3d place = Isometry3d::Identity();
    place.translation() = Vector3d(0.03, 0.04, 0.08);
    return place;
}

double in_px(const std::optional<YamlMeasure>& measure) {
    return measure ? px_per_kpx * measure->to_si() : 0;
}

Distortion distortion_of(const YamlValue& model) {
    if (model.is_text("none")) return Distortion::None;
    if (model.is_text("brown_conrady")) return Distortion::BrownConrady;
    if (model.is_text("fisheye")) return Distortion::Fisheye;
    throw model.error("is " + quote(model.text()) + "; must be none, brown_conrady or fisheye");
}

void read_distortion(const YamlValue& value, Intrinsics& intrinsics) {
    const YamlMap map(value, keys::camera, "distortion");
    intrinsics.distortion = distortion_of(map.require("model"));
    const auto coefficients = map.find("coefficients");
    if (!coefficients) {
        if (intrinsics.distortion == Distortion::None) return;
        throw value.error("has no key 'coefficients'; it must be stated, 0 for those to be found");
    }
    for (const YamlValue& one : coefficients->list()) {
        intrinsics.coefficients.push_back(one.number());
        constexpr double most = 1e6;
        if (std::abs(intrinsics.coefficients.back()) > most) {
            throw one.error("is over 1e6 in magnitude, which no lens has");
        }
    }
    const std::size_t count = intrinsics.coefficients.size();
    const bool is_one = intrinsics.distortion == Distortion::BrownConrady
                            ? count == 4 || count == 5 || count == 8
                            : count == (intrinsics.distortion == Distortion::None ? 0U : 4U);
    if (is_one) return;
    throw coefficients->error(fmt::format(
        "has {} numbers; must have 4, 5 or 8 of brown_conrady, 4 of fisheye, 0 of none", count));
}

/// What is stated in the campaign itself.
CameraFile read_numbers(const YamlMap& map) {
    CameraFile camera;
    Intrinsics& intrinsics = camera.intrinsics;
    const std::array<std::pair<const char*, double*>, 4> numbers{{{"fx", &intrinsics.fx},
                                                                  {"fy", &intrinsics.fy},
                                                                  {"cx", &intrinsics.cx},
                                                                  {"cy", &intrinsics.cy}}};
    for (const auto& [name, number] : numbers) *number = in_px(map.find_measure(name));
    for (const char* const name : {"fx", "fy"}) {
        const auto focal = map.find_measure(name);
        if (focal && focal->to_si() < 0) throw focal->value.error("is negative; must be above 0");
    }
    if (const auto distortion = map.find("distortion")) read_distortion(*distortion, intrinsics);
    return camera;
}

CameraFile read_stated(const YamlValue& value, const YamlMap& map, Index camera) {
    const auto file = map.find("file");
    if (!file) return read_numbers(map);
    for (const YamlEntry& entry : value.entries()) {
        const bool is_own = entry.key == "known" || entry.key == "deviations";
        if (entry.key == "file" || is_own) continue;
        throw entry.value.error("is stated beside 'file'; must be left out, the file has it");
    }
    return read_camera_file(*file, camera);
}

/// By names: "fx_px", ..., "k1"; these are known then. `is_exact`: what is stated to be.
void read_deviations(const YamlValue& value, const std::vector<bool>& is_exact,
                     SingleCamera& setup) {
    if (value.is_map() && value.entries().empty()) {
        throw value.error("is empty; must state one deviation at least, or be left out");
    }
    std::vector<std::string> names = setup.intrinsics.names();
    for (std::size_t k = 0; k < 4; ++k) names[k] += "_px";
    setup.deviations.assign(names.size(), 0);
    for (const YamlEntry& entry : value.entries()) {
        const auto found = std::ranges::find(names, entry.key);
        if (found == names.end()) {
            throw entry.value.error("is of no intrinsic parameter; " + suggest(entry.key, names));
        }
        const auto k = static_cast<std::size_t>(found - names.begin());
        if (is_exact[k]) {
            throw entry.value.error(fmt::format(
                "is stated beside 'known', by which {} is exact; must stand in one of them",
                setup.intrinsics.names()[k]));
        }
        const double deviation = entry.value.number();
        if (!(deviation > 0)) throw entry.value.error("must be above 0");
        setup.is_known[k] = true;
        setup.deviations[k] = k < 4 ? deviation / px_per_kpx : deviation;
    }
}

/// Where the image of a lens ends to grow outwards, px from the principal point: the least of both
/// axes.
double fold_radius(const Intrinsics& intrinsics) {
    Lens lens = lens_of(intrinsics);
    if (lens.distortion == Distortion::BrownConrady) lens.values[6] = lens.values[7] = 0;  // p1, p2
    const Vector3d widest(widest_tangent(lens), 0, 1);
    const double along_x = place_of(lens, widest).x() / kpx_per_px - intrinsics.cx;
    return along_x * std::min(1.0, intrinsics.fy / intrinsics.fx);
}

/// No lens shows two directions at one place of its image.
void check_folds(const YamlMap& map, const SingleCamera& setup) {
    const Intrinsics& lens = setup.intrinsics;
    if (!setup.image || lens.distortion == Distortion::None || !(lens.fx > 0 && lens.fy > 0))
        return;
    const double edge =
        std::min({lens.cx, lens.cy, setup.image->x() - lens.cx, setup.image->y() - lens.cy});
    const double radius = fold_radius(lens);
    if (!(edge > 0 && radius < edge)) return;
    const auto stated = map.find("distortion");
    throw(stated ? *stated : map.require("file"))
        .error(fmt::format(
            "folds the image onto itself from {:.0f} px from the principal point on, within the "
            "image, whose nearest edge is {:.0f} px away; must be of a lens whose image grows "
            "outwards there: are model, coefficients and focal lengths right?",
            radius, edge));
}

/// `number`: of the camera, from 0.
void read_intrinsics(const YamlValue& value, Index number, SingleCamera& setup) {
    const YamlMap map(value, keys::camera, "intrinsics");
    const CameraFile camera = read_stated(value, map, number);
    setup.intrinsics = camera.intrinsics;
    const auto names = setup.intrinsics.names();
    const auto known = map.find("known");
    setup.is_known = known ? read_known(*known, names) : std::vector<bool>(names.size(), true);
    if (const auto deviations = map.find("deviations")) {
        const std::vector<bool> is_exact =
            known ? setup.is_known : std::vector<bool>(names.size(), false);
        read_deviations(*deviations, is_exact, setup);
    }
    for (std::size_t k = 0; k < 2; ++k) {
        const double focal = k == 0 ? setup.intrinsics.fx : setup.intrinsics.fy;
        if (setup.is_known[k] && !(focal > 0)) {
            throw value.error(fmt::format(
                "has no {}_px above 0, which is said to be known; must be stated, or known: false",
                names[k]));
        }
    }
    if ((setup.intrinsics.fx > 0) != (setup.intrinsics.fy > 0)) {
        throw value.error("states one focal length; must state both fx_px and fy_px, or none");
    }
    if (camera.image && !setup.image) setup.image = camera.image;
    if (camera.image && *setup.image != *camera.image) {
        throw value.error(fmt::format(
            "is of an image of {:g} by {:g} px, image_px is {:g} by {:g}; must be of the same "
            "image, neither scaled nor turned",
            camera.image->x(), camera.image->y(), setup.image->x(), setup.image->y()));
    }
    check_folds(map, setup);
}

/// What is not stated stays as it is.
void read_growth(const YamlMap& sensor, NoiseGrowth& growth) {
    const auto value = sensor.find("noise");
    if (!value) return;
    if (value->is_map() && value->entries().empty()) {
        throw value->error(
            "is empty; must state tilt, or focus_mm and aperture_mm, or be left out");
    }
    const YamlMap noise(*value, keys::noise, "camera");
    if (const auto tilt = noise.find("tilt")) growth.tilt = tilt->number();
    const auto focus = noise.find_measure("focus"), aperture = noise.find_measure("aperture");
    if (focus.has_value() != aperture.has_value()) {
        throw value->error("must state both focus_mm and aperture_mm, or none of them");
    }
    if (focus) growth.focus = read_positive(*focus);
    if (aperture) growth.aperture = read_positive(*aperture);
    try {
        check_growth(growth);
    } catch (const InputError& e) {
        throw value->error(std::string("cannot be used: ") + e.what());
    }
}

void read_depths(const YamlMap& map, CameraView& view) {
    if (const auto nearest = map.find_measure("nearest"))
        view.nearest = read_positive(*nearest, true);
    const auto farthest = map.find_measure("farthest");
    if (!farthest) return;
    view.farthest = read_positive(*farthest);
    if (view.farthest > view.nearest) return;
    throw farthest->value.error(
        fmt::format("is {}, not beyond nearest_mm", quote(farthest->value.text())));
}

void read_view(const YamlValue& value, CameraSetup& setup) {
    const YamlMap view(value, keys::camera, "view");
    read_depths(view, setup.view);
    if (const auto line = view.find("line_of_sight")) {
        setup.view.is_line_required = line->boolean();
    }
    if (const auto tilt = view.find_measure("most_tilt")) {
        setup.view.most_tilt = read_positive(*tilt, false, 1.5707963267948966);
    }
    if (const auto least = view.find("least_corners")) {
        setup.view.least_corners = static_cast<Index>(
            least->natural_number(1, setup.corners.size(), ", the board's corners"));
    }
    const auto front = view.find("front");
    if (!front) return;
    setup.view.is_front_plus_z = front->is_text("+z");
    if (!setup.view.is_front_plus_z && !front->is_text("-z")) {
        throw front->error("is " + quote(front->text()) + "; must be -z or +z");
    }
}

void read_image(const YamlMap& sensor, SingleCamera& setup) {
    const auto image = sensor.find_measure("image");
    if (!image) return;
    const VectorXd size = px_per_kpx * image->list_to_si(2);
    constexpr double rounding = 1e-6;  // px
    const bool is_whole = (size - size.array().round().matrix()).cwiseAbs().maxCoeff() < rounding;
    if (!(size.minCoeff() >= 1) || !is_whole) {
        throw image->value.error(
            "must be a width and a height, each a whole number of pixels, at least 1");
    }
    setup.image = size;
}

/// Reads the further cameras. `are_placed` becomes false where the file does not place one.
std::vector<PlacedCamera> read_others(const YamlValue& list, CameraSetup& setup, bool& are_placed) {
    constexpr std::size_t most = 16;
    const std::vector<YamlValue> values = list.list();
    if (values.empty() || values.size() > most) {
        throw list.error(fmt::format("lists {} cameras; must be from 1 to {} beside the first one",
                                     values.size(), most));
    }
    std::vector<PlacedCamera> placed;
    for (const YamlValue& value : values) {
        const YamlMap map(value, keys::camera, "other_cameras");
        SingleCamera camera;
        const auto sigma = map.find_measure("sigma");
        camera.sigma = sigma ? px_per_kpx * read_positive(*sigma) : setup.sigma;
        camera.growth = setup.growth;
        read_growth(map, camera.growth);
        read_image(map, camera);
        const Index number = 1 + static_cast<Index>(setup.others.size());
        read_intrinsics(map.require("intrinsics"), number, camera);
        placed.push_back({Isometry3d::Identity(), camera.intrinsics});
        if (const auto place = map.find("place")) {
            placed.back().in_first = read_frame(YamlMap(*place, keys::places, "place"));
        } else {
            are_placed = false;
        }
        are_placed = are_placed && camera.intrinsics.fx > 0;
        setup.others.push_back(std::move(camera));
    }
    return placed;
}

/// Where what is on the flange is, if it is stated.
std::optional<Isometry3d> read_place(const YamlMap& sensor, CameraSetup& setup) {
    const auto value = sensor.find("place");
    if (!value) return std::nullopt;
    const YamlMap map(*value, keys::places, "place");
    const Isometry3d place = read_frame(map);
    if (is_true(map, "known")) setup.known_place = place;
    return place;
}

SensorSection make_camera(const YamlValue& board, CameraSetup setup, const Isometry3d& place,
                          const std::vector<PlacedCamera>& others, bool are_placed) {
    try {
        auto camera = std::make_shared<CameraSensor>(std::move(setup));
        VectorXd unknowns = camera->unknowns(place, camera->setup().intrinsics, others);
        return {std::move(camera), std::move(unknowns), are_placed};
    } catch (const InputError& e) {
        throw board.error(std::string("cannot be used: ") + e.what());
    }
}

}  // namespace

SensorSection read_another_board(const YamlValue& value, const CameraSensor& camera) {
    const YamlMap sensor(value, keys::sensor, "camera");
    CameraSetup setup = camera.setup();
    const std::set<std::string_view> own{"kind", "same_camera", "board", "view",
                                         setup.is_on_flange ? "frame" : "place"};
    for (const YamlEntry& entry : value.entries()) {
        if (own.contains(entry.key)) continue;
        throw entry.value.error(fmt::format(
            "is that of the same camera, stated before; must be left out ({} are its own)",
            setup.is_on_flange ? "board, view and frame" : "board, view and place"));
    }
    setup.corners.clear();
    setup.corner_sigma = 0;
    setup.first_corner = 1;
    setup.pattern = {};
    const YamlValue board = sensor.require("board");
    read_board(board, setup);
    setup.view.least_corners = std::min(setup.view.least_corners, std::ssize(setup.corners));
    if (const auto view = sensor.find("view")) read_view(*view, setup);
    if (setup.is_on_flange) return make_camera(board, std::move(setup), generic_place(), {}, true);
    setup.known_place.reset();
    const auto place = read_place(sensor, setup);
    return make_camera(board, std::move(setup), place.value_or(generic_place()), {},
                       place.has_value());
}

SensorSection read_camera(const YamlValue& value) {
    const YamlMap sensor(value, keys::sensor, "camera");
    CameraSetup setup;
    const YamlValue mounting = sensor.require("camera");
    setup.is_on_flange = mounting.is_text("flange");
    if (!setup.is_on_flange && !mounting.is_text("fixed")) {
        throw mounting.error("is " + quote(mounting.text()) + "; must be flange or fixed");
    }
    setup.sigma = px_per_kpx * read_positive(sensor.require_measure("sigma"));
    read_growth(sensor, setup.growth);
    read_image(sensor, setup);
    read_intrinsics(sensor.require("intrinsics"), 0, setup);
    const YamlValue board = sensor.require("board");
    read_board(board, setup);
    if (const auto view = sensor.find("view")) read_view(*view, setup);
    const auto place = read_place(sensor, setup);
    bool are_placed = place && setup.intrinsics.fx > 0;
    std::vector<PlacedCamera> others;
    if (const auto list = sensor.find("other_cameras")) {
        others = read_others(*list, setup, are_placed);
    }
    return make_camera(board, std::move(setup), place.value_or(generic_place()), others,
                       are_placed);
}

}  // namespace posewise::detail
