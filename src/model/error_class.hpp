#pragma once

#include "core/names.hpp"
#include "posewise/model/chain.hpp"

namespace posewise::detail {

/// What an error parameter is an error of.
enum class ErrorClass {
    Length,
    Slide,
    Angle,
    Offset,
    Gravity,
    Torque,
    Harmonic,
    SlideHarmonic,
    Tilt,
    Gain,
    Other
};

/// Their words where errors are named by class: offsets of both kinds of joints are one, so are
/// their harmonics, and what gravity does is one.
inline constexpr Names<ErrorClass, 11> error_class_names{{{ErrorClass::Offset, "offsets"},
                                                          {ErrorClass::Slide, "offsets"},
                                                          {ErrorClass::Length, "lengths"},
                                                          {ErrorClass::Angle, "angles"},
                                                          {ErrorClass::Gravity, "gravity"},
                                                          {ErrorClass::Torque, "gravity"},
                                                          {ErrorClass::Harmonic, "harmonics"},
                                                          {ErrorClass::SlideHarmonic, "harmonics"},
                                                          {ErrorClass::Tilt, "tilts"},
                                                          {ErrorClass::Gain, "gains"},
                                                          {ErrorClass::Other, "terms"}}};

ErrorClass error_class_of(const Chain& robot, Index parameter);

}  // namespace posewise::detail
