#pragma once

#include <string>

#include "posewise/io/urdf_file.hpp"
#include "posewise/model/comparison.hpp"
#include "posewise/model/dh.hpp"
#include "posewise/model/ur_frames.hpp"

/// A calibrated robot in forms that others read. What is written is read back before it takes the
/// place of what stood there: all throw InputError, and leave the place as it was, if the flange is
/// then farther than 1e-9 m or 1e-9 rad from where `robot` has it with these errors (error terms
/// left out) at any of 1000 configurations, or if the place is none for a file. They return how far
/// it is.
namespace posewise::io {

/// `urdf` is make_calibrated_urdf() of the other arguments. What it could not express is left out.
FlangeDifference write_calibrated_urdf(const std::string& path, const CalibratedUrdf& urdf,
                                       const UrdfSource& source, const Chain& robot,
                                       const VectorXd& errors);

/// `rows` are dh_rows() of the robot; `title` is put in front as a comment.
FlangeDifference write_dh(const std::string& path, const std::string& title,
                          const std::vector<DhRow>& rows, const Chain& robot,
                          const VectorXd& errors);

/// The file config/<type>/default_kinematics.yaml of ur_description, a package of ROS: `frames` are
/// ur_frames() of the robot. Its hash, "posewise_" and 16 digits, is a checksum of the numbers; the
/// controller's own, "calib_...", names the factory's.
FlangeDifference write_ur_kinematics(const std::string& path, const std::string& title,
                                     const UrFrames& frames, const Chain& robot,
                                     const VectorXd& errors);

/// Throws InputError with path:line:column for another file.
UrFrames read_ur_kinematics(const std::string& path);

}  // namespace posewise::io
