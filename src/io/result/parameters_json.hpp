#pragma once

#include "io/format/json.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise::detail {

/// The base three ways that agree: `position_m`, `quaternion_wxyz`, `rpy_deg`.
Json base_to_json(const Isometry3d& world_from_base);

/// `base`; `robot`: of each error its value (added to the nominal one) and, of all parameters'
/// `sigmas` unless they are null, its standard deviation; `targets`, or `sensor` of a sensor that
/// observes none.
Json parameters_to_json(const Campaign& campaign, const Parameters& parameters,
                        const VectorXd* sigmas = nullptr);

}  // namespace posewise::detail
