#pragma once

#include "posewise/measurement/sensor.hpp"
#include "posewise/measurement/sensors.hpp"

/// What sensors that observe points say of their noise.
namespace posewise::detail {

/// "sigma_m", or for a laser tracker its two sigmas and its position.
std::vector<NoiseNumber> noise_numbers(const PointNoise& noise);

/// "sigma 0.05 mm".
std::string describe(const PointNoise& noise);

/// Throws InputError if `sigma` (m or rad, by `unit`) is not finite or below 1e-15.
void check_sigma(const char* name, double sigma, const char* unit);

}  // namespace posewise::detail
