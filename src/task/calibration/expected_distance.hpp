#pragma once

#include "posewise/calibrator/estimate.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise::detail {

/// Another robot's measurements are off by more than so many expected errors.
inline constexpr double credible_errors = 10;

/// States a robot of which nothing is known but the sizes expected of its errors.
Estimate uncalibrated(const Campaign& campaign, const Parameters& at);

/// By how much the nominal robot is expected to miss the points measured, as the spread, the model
/// error and the instrument's noise say: RMS, m.
double expected_distance(const Campaign& campaign, const Measurements& measured);

/// By how much readings (RMS of a target's means; m, or of angles, rad) are off that no robot of
/// this kind explains: what one is expected to miss them by before it is calibrated, base and
/// targets fitted, if it has every geometric error of the sizes expected here, model error and
/// noise.
double largest_left_over(const Campaign& campaign, const Parameters& at,
                         const Measurements& measured, bool is_angle);

/// The same of a camera's corners at the configurations that show it the board, or at random ones
/// that do where most of those measured do not.
double expected_pixels(const Campaign& campaign, const Parameters& at,
                       const Measurements& measured);

/// The same beside the camera's place as the campaign states it; infinite where it states none, or
/// one that shows no board.
double expected_pixels_as_stated(const Campaign& campaign, const Measurements& measured);

/// Half of the points (m) or corners (1000 px) may be off by so much. Infinite where it is not
/// known: of other angles, and of a camera whose place is not stated.
double credible_distance(const Campaign& campaign, const Measurements& measured);

}  // namespace posewise::detail
