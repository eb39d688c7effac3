#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/task/calibration.hpp"

namespace posewise {
namespace {

constexpr Index cells_along = 8, cells_across = 6;
constexpr Index outer = 2;  // cells of an outer zone
constexpr std::size_t zone_count = 9;

/// The cell of a place between 0 and `size`.
Index cell_at(double place, double size, Index cells) {
    const auto cell = static_cast<Index>(static_cast<double>(cells) * place / size);
    return std::clamp<Index>(cell, 0, cells - 1);
}

/// 0, 1 or 2: the first cells, the middle ones, the last ones.
Index third_of(Index cell, Index cells) { return cell < outer ? 0 : cell < cells - outer ? 1 : 2; }

std::vector<std::string> empty_zones(const ImageCoverage& image) {
    constexpr std::array<const char*, zone_count> names{"top left",    "top",    "top right",
                                                        "left",        "middle", "right",
                                                        "bottom left", "bottom", "bottom right"};
    std::array<Index, zone_count> in_zone{};
    for (Index cell = 0; cell < std::ssize(image.counts); ++cell) {
        const Index zone = 3 * third_of(cell / image.columns, image.rows) +
                           third_of(cell % image.columns, image.columns);
        in_zone[static_cast<std::size_t>(zone)] += image.counts[static_cast<std::size_t>(cell)];
    }
    std::vector<std::string> empty;
    for (std::size_t zone = 0; zone < names.size(); ++zone) {
        if (in_zone[zone] == 0) empty.emplace_back(names[zone]);
    }
    return empty;
}

ImageCoverage cover(const CameraImage& of, const std::array<double, 2>& size,
                    const Measurements& measurements, const Sensor& sensor) {
    ImageCoverage image{of.camera, size, cells_along, cells_across, {}, 0, {}, of.name, of.sensor};
    if (size[1] > size[0]) std::swap(image.columns, image.rows);
    image.counts.assign(static_cast<std::size_t>(image.columns * image.rows), 0);
    const auto count = [&](Index sample, Index target) {
        if (!measurements.is_seen(sample, target)) return;
        const Vector2d place =
            1e3 * measurements.observations.row(sample).segment<2>(sensor.first_row(target));
        const Index cell = image.columns * cell_at(place.y(), size[1], image.rows) +
                           cell_at(place.x(), size[0], image.columns);
        ++image.counts[static_cast<std::size_t>(cell)];
    };
    for (const auto& [first, corners] : of.targets) {
        for (Index sample = 0; sample < measurements.is_seen.rows(); ++sample) {
            for (Index target = first; target < first + corners; ++target) count(sample, target);
        }
    }
    const auto covered = std::ssize(image.counts) - std::ranges::count(image.counts, 0);
    image.part = static_cast<double>(covered) / static_cast<double>(image.counts.size());
    image.empty = empty_zones(image);
    return image;
}

/// Adds those of one sensor whose targets begin at `first_target`.
void add_images(const Sensor& sensor, Index first_target, std::optional<Index> number,
                std::vector<CameraImage>& images) {
    const auto* const cameras = dynamic_cast<const CameraSensor*>(&sensor);
    if (cameras == nullptr) return;
    const Index corners = cameras->corner_count();
    for (Index camera = 0; camera < cameras->camera_count(); ++camera) {
        CameraImage& image = images.emplace_back(
            CameraImage{camera, number, {}, {{first_target + camera * corners, corners}}, {}});
        if (const auto& size = cameras->camera(camera).image) image.size = {size->x(), size->y()};
    }
}

/// Of one sensor that has further cameras, of several that have one each, or of both.
std::string name_of(const CameraImage& image, const std::vector<CameraImage>& images) {
    if (images.size() == 1) return "";
    const std::string camera = fmt::format("camera {}", image.camera + 1);
    if (!image.sensor) return camera;
    const std::string sensor = fmt::format("sensor {}", *image.sensor + 1);
    const auto of_sensor = std::ranges::count(images, image.sensor, &CameraImage::sensor);
    return of_sensor == 1 ? sensor : camera + " of " + sensor;
}

std::vector<CameraImage> images_of_parts(const CombinedSensor& combined) {
    std::vector<CameraImage> images;
    for (Index part = 0; part < combined.part_count(); ++part) {
        const SensorPart& stated = combined.part(part);
        std::vector<CameraImage> of_part;
        add_images(*stated.sensor, combined.first_target(part), part, of_part);
        for (CameraImage& image : of_part) {
            const auto same = std::ranges::find_if(images, [&](const CameraImage& other) {
                return stated.same_camera && other.sensor == stated.same_camera &&
                       other.camera == image.camera;
            });
            if (same == images.end()) {
                images.push_back(std::move(image));
            } else {
                same->targets.push_back(image.targets.front());
            }
        }
    }
    return images;
}

}  // namespace

std::vector<CameraImage> camera_images(const Sensor& sensor) {
    std::vector<CameraImage> images;
    if (const auto* const combined = dynamic_cast<const CombinedSensor*>(&sensor)) {
        images = images_of_parts(*combined);
    } else {
        add_images(sensor, 0, {}, images);
    }
    for (CameraImage& image : images) image.name = name_of(image, images);
    return images;
}

std::vector<ImageCoverage> find_image_coverage(const Sensor& sensor,
                                               const Measurements& measurements) {
    std::vector<ImageCoverage> images;
    for (const CameraImage& image : camera_images(sensor)) {
        if (image.size) images.push_back(cover(image, *image.size, measurements, sensor));
    }
    return images;
}

}  // namespace posewise
