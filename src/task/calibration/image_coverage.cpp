#include <algorithm>
#include <array>
#include <utility>

#include "posewise/measurement/camera_sensor.hpp"
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

ImageCoverage cover(const CameraSensor& sensor, Index camera, const Vector2d& size,
                    const Measurements& measurements) {
    ImageCoverage image{camera, {size.x(), size.y()}, cells_along, cells_across, {}, 0, {}};
    if (size.y() > size.x()) std::swap(image.columns, image.rows);
    image.counts.assign(static_cast<std::size_t>(image.columns * image.rows), 0);
    const Index first = camera * sensor.corner_count();
    for (Index sample = 0; sample < measurements.is_seen.rows(); ++sample) {
        for (Index target = first; target < first + sensor.corner_count(); ++target) {
            if (!measurements.is_seen(sample, target)) continue;
            const Vector2d place = 1e3 * measurements.observation(sample, target).transpose();
            const Index cell = image.columns * cell_at(place.y(), size.y(), image.rows) +
                               cell_at(place.x(), size.x(), image.columns);
            ++image.counts[static_cast<std::size_t>(cell)];
        }
    }
    const auto covered = std::ssize(image.counts) - std::ranges::count(image.counts, 0);
    image.part = static_cast<double>(covered) / static_cast<double>(image.counts.size());
    image.empty = empty_zones(image);
    return image;
}

}  // namespace

std::vector<ImageCoverage> find_image_coverage(const Sensor& sensor,
                                               const Measurements& measurements) {
    std::vector<ImageCoverage> images;
    const auto* const cameras = dynamic_cast<const CameraSensor*>(&sensor);
    if (cameras == nullptr) return images;
    for (Index camera = 0; camera < cameras->camera_count(); ++camera) {
        if (const auto& size = cameras->camera(camera).image) {
            images.push_back(cover(*cameras, camera, *size, measurements));
        }
    }
    return images;
}

}  // namespace posewise
