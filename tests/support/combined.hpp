#pragma once

#include <string>

/// Campaign files of several sensors that see one arm.
namespace posewise::testing {

/// Joints and elements of a small arm, for its section `robot`.
inline const std::string small_arm = R"(  joints:
    q1: {limits_deg: [-180, 180]}
    q2: {limits_deg: [-180, 0]}
    q3: {limits_deg: [-150, 150]}
    q4: {limits_deg: [-180, 180]}
    q5: {limits_deg: [-180, 180]}
    q6: {limits_deg: [-180, 180]}
  elements:
    [Rz q1, Tz 89.2 mm, Rx 90 deg, Rz q2, Tx -425 mm, Rz q3, Tx -392 mm, Rz q4, Tz 109.3 mm,
     Rx 90 deg, Rz q5, Tz 94.75 mm, Rx -90 deg, Rz q6, Tz 82.5 mm]
)";

inline const std::string combined_arm =
    "robot:\n  errors: geometric\n  class: collaborative\n" + small_arm;

inline const std::string tracker_part = R"(  - kind: points
    noise: {range_um: 15, angle_urad: 15}
    targets: {position_mm: [[30, -40, 40], [-60, 30, 30]]}
)";

inline const std::string tracked_base =
    "base: {position_mm: [2500, 400, -600], rpy_deg: [0, 0, 150]}\n";

/// A fixed camera before the arm, a board on its flange.
inline const std::string tracker_and_camera = "name: tracker and camera\n" + combined_arm +
                                              tracked_base + "sensors:\n" + tracker_part +
                                              R"(  - kind: camera
    camera: fixed
    image_px: [2448, 2048]
    sigma_px: 0.2
    intrinsics: {fx_px: 2400, fy_px: 2400, cx_px: 1224, cy_px: 1024, known: false,
                 distortion: {model: brown_conrady, coefficients: [-0.1, 0, 0, 0, 0]}}
    board: {columns: 6, rows: 4, square_mm: 30}
    place: {position_mm: [20, 30, 60], rpy_deg: [165, 0, 10]}
    frame: {position_mm: [1151, 1063, 200], rpy_deg: [-107, 0, -116]}
)";

inline const std::string tracker_alone = R"(name: tracker alone
)" + combined_arm + tracked_base + R"(sensor:
  kind: points
  noise: {range_um: 15, angle_urad: 15}
  targets: {position_mm: [[30, -40, 40], [-60, 30, 30]]}
)";

/// A camera on the flange before a board, the first one.
inline const std::string camera_part =
    R"(base: {position_mm: [87, 550, 0], rpy_deg: [180, 0, 90]}
sensors:
  - kind: camera
    camera: flange
    image_px: [1280, 960]
    sigma_px: 0.3
    intrinsics: {fx_px: 1210, fy_px: 1210, cx_px: 640, cy_px: 480, known: false,
                 distortion: {model: brown_conrady, coefficients: [-0.1, 0, 0, 0, 0]}}
    board: {columns: 8, rows: 5, square_mm: 25}
    place: {position_mm: [30, 40, 60], rpy_deg: [0, 0, 0]}
    view: {most_tilt_deg: 55, least_corners: 20}
)";

/// A camera on the flange before a board, a tip that touches faces whose places are found.
inline const std::string camera_and_planes = "name: camera and planes\n" + combined_arm +
                                             camera_part +
                                             R"(  - kind: planes
    sigma_mm: 0.02
    planes:
      - {normal: [0, 0, -1], offset_mm: 0}
      - {normal: [1, 0, 0], offset_mm: -200}
      - {normal: [0, 1, 0], offset_mm: -300}
    targets: {position_mm: [[60, 0, 120]]}
    frame: first
)";

/// A camera on the flange before two boards that it seldom sees together.
inline const std::string two_boards = "name: two boards\n" + combined_arm + camera_part +
                                      R"(  - kind: camera
    same_camera: 1
    board: {columns: 5, rows: 4, square_mm: 30, first_point: 0}
    view: {least_corners: 12}
    frame: {position_mm: [500, 100, -50], rpy_deg: [0, -25, 10]}
)";

}  // namespace posewise::testing
