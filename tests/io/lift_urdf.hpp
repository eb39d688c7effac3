#pragma once

#include <string>
#include <vector>

#include "posewise/io/robot_files.hpp"
#include "support/slips.hpp"
#include "support/temporary_folder.hpp"

/// A robot as a URDF, and what is said of it with something changed.
namespace posewise::testing {

/// A column that slides, an arm behind a fixed joint, a wrist; a finger that mimics beside the way.
inline const std::string lift_urdf = R"(<?xml version="1.0"?>
<!-- A robot -->
<robot name="lift &amp; arm">
  <link name="base"/>
  <link name="column"/>
  <link name="plate"/>
  <link name="arm"/>
  <link name="tool"/>
  <link name="finger"/>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="column"/>
    <origin xyz="0.1 0 0.5"/>
    <axis xyz="0 0 2"/>
    <limit lower="0" upper="0.8" effort="100" velocity="0.5"/>
  </joint>
  <joint name="mount" type="fixed">
    <origin xyz="0 0.2 0" rpy="0.1 -0.2 1.5"/>
    <parent link="column"/><child link="plate"/>
  </joint>
  <joint name="arm-joint" type="revolute">
    <parent link="plate"/><child link="arm"/>
    <origin rpy="0.4 0 0" xyz="0 0 0.3"/>
    <axis xyz="0 -1 0"/>
    <limit lower="-1.5" upper="2" effort="10" velocity="1.5"/>
  </joint>
  <joint name="wrist" type="continuous">
    <parent link="arm"/><child link="tool"/>
    <origin xyz="0.4 0 0"/>
  </joint>
  <joint name="grip" type="revolute">
    <parent link="tool"/><child link="finger"/>
    <mimic joint="wrist"/>
  </joint>
</robot>
)";

inline io::UrdfRobot read(const std::string& content, const std::string& base = "base",
                          const std::string& tip = "tool") {
    const TemporaryFolder folder;
    return io::read_urdf({folder.write("robot.urdf", content), base, tip});
}

inline std::string error_of(const std::string& content, const std::string& base = "base",
                            const std::string& tip = "tool") {
    return input_error_of([&] { io::make_chain(read(content, base, tip)); });
}

inline void expect_messages_of(const std::vector<Slip>& slips) {
    const auto error = [](const std::string& changed) { return error_of(changed); };
    expect_messages(lift_urdf, slips, error, "robot.urdf:");
}

}  // namespace posewise::testing
