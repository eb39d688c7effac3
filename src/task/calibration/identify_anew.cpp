#include "identify_anew.hpp"

#include <utility>

#include "posewise/calibrator/identification.hpp"

namespace posewise::detail {

std::optional<Estimate> identify_anew(const Campaign& campaign, const Measurements& measurements,
                                      const LevenbergMarquardtOptions& options) {
    const Registration registration = register_base_and_targets(campaign, measurements);
    if (!registration.is_determined()) return std::nullopt;
    Estimate found = identify(campaign, measurements, registration.parameters, options);
    if (!found.undetermined.empty()) return std::nullopt;
    return found;
}

}  // namespace posewise::detail
