#include "noise_words.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/format.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"

namespace posewise::detail {
namespace {

std::vector<double> list(const Vector3d& vector) { return {vector.begin(), vector.end()}; }

struct Numbers {
    using Result = std::vector<NoiseNumber>;

    Result operator()(const IsotropicNoise& noise) const { return {{"sigma_m", {noise.sigma}}}; }
    Result operator()(const PerAxisNoise& noise) const { return {{"sigma_m", list(noise.sigma)}}; }
    Result operator()(const LaserTrackerNoise& noise) const {
        return {{"range_sigma_m", {noise.range_sigma}},
                {"angle_sigma_rad", {noise.angle_sigma}},
                {"tracker_position_m", list(noise.position)}};
    }
};

struct Words {
    std::string operator()(const IsotropicNoise& noise) const {
        return fmt::format("sigma {} mm", format_short(mm_per_m * noise.sigma));
    }
    std::string operator()(const PerAxisNoise& noise) const {
        return fmt::format(
            "sigma {}, {} and {} mm along x, y and z", format_short(mm_per_m * noise.sigma.x()),
            format_short(mm_per_m * noise.sigma.y()), format_short(mm_per_m * noise.sigma.z()));
    }
    std::string operator()(const LaserTrackerNoise& noise) const {
        return fmt::format("laser tracker with sigma {} um in range and {} urad in angle",
                           format_short(1e6 * noise.range_sigma),
                           format_short(1e6 * noise.angle_sigma));
    }
};

}  // namespace

void check_sigma(const char* name, double sigma, const char* unit) {
    constexpr double least = 1e-15;  // its square is a normal number, its inverse finite
    if (sigma >= least && std::isfinite(sigma)) return;
    throw InputError(fmt::format("{} is {:g} {}, must be finite and at least 1e-15 {}", name, sigma,
                                 unit, unit));
}

std::vector<NoiseNumber> noise_numbers(const PointNoise& noise) {
    return std::visit(Numbers{}, noise);
}

std::string describe(const PointNoise& noise) { return std::visit(Words{}, noise); }

}  // namespace posewise::detail
