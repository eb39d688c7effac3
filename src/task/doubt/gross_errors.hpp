#pragma once

namespace posewise::detail {

/// A robot's maker is rarely wrong by 10 cm, nor by 5 deg.
inline constexpr double gross_distance = 0.1;  // m
inline constexpr double gross_angle = 0.1;     // rad

}  // namespace posewise::detail
