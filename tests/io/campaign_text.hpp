#pragma once

#include <string>

#include "support/slips.hpp"

namespace posewise::testing {

/// Two turning joints, for campaigns whose sensor matters.
inline const std::string two_joint_arm =
    "name: arm\n"
    "robot:\n"
    "  joints:\n"
    "    q1: {limits_deg: [-170, 170]}\n"
    "    q2: {limits_deg: [-90, 90]}\n"
    "  elements: [Rz q1, Tx 400 mm, Ry q2, Tx 300 mm]\n";

/// A small campaign file with everything in it: one sliding and two turning joints.
inline const std::string campaign_text = R"(name: crane
robot:
  joints:
    q1: {limits_deg: [-90, 90]}
    q2: {limits_rad: [-1, 1.5]}
    lift: {limits_mm: [0, 500]}
  elements:
    - Rz q1 [dq1]
    - Tz lift
    - Tx 312 mm [Tx1]
    - Ry -q2 + 0.5*q1 + 90 deg [dq2]
    - Ty 0 [Ty2]
    - Tx -1.5 m
sensor:
  kind: points
  sigma_mm: 0.05
  targets: {position_mm: [[100, 0, 0], [0, 200, -10]]}
model_error_mm: 0.2
base: {position_mm: [1000, 0, -500], rpy_deg: [0, 0, 90]}
spread: {length_mm: 2, angle_mrad: 3, parameters: {dq2: 0.5 mrad, Tx1: 4 mm}}
criterion: o3
seed: 7
measurements:
  mat: {joints: q, points: [mA, mB], angle_unit: deg, length_unit: mm}
)";

}  // namespace posewise::testing
