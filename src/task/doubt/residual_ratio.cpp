#include "residual_ratio.hpp"

#include <algorithm>
#include <cmath>

#include "core/statistics.hpp"

namespace posewise::detail {

std::optional<double> clear_ratio(const ResidualVariance& variance, LossKind loss) {
    constexpr double tolerated = 1.2;  // intervals of 95 % would hold 90 %
    constexpr double chance = 1e-3;    // of a doubt without a reason, on either side
    // Degrees of freedom for which the median tells as much as the mean square [Rousseeuw & Croux
    // 1993].
    const double efficiency = loss == LossKind::Squares ? 1 : 0.37;
    if (variance.degrees_of_freedom <= 0) return std::nullopt;
    const double freedom = efficiency * variance.degrees_of_freedom;
    const double squares = freedom * variance.factor;
    const double ratio = std::sqrt(variance.factor);
    const bool is_chance = squares >= chi_squared_quantile(chance, freedom) &&
                           squares <= chi_squared_quantile(1 - chance, freedom);
    if (is_chance || (ratio <= tolerated && ratio >= 1 / tolerated)) return std::nullopt;
    return ratio;
}

double fitting_model_error(const Campaign& found, const Estimate& estimate,
                           const ExpectedError& expected, bool is_angle) {
    const double factor = estimate.variance_of(is_angle).factor;
    if (!(factor > 0)) return 0;
    // Without priors the expected errors are scaled by the factor already.
    const double scaled = found.spread.is_prior ? 1 : factor;
    const double noise = expected.noise * expected.noise / scaled;
    const double model = expected.model * expected.model / scaled;
    const Index lengths = found.sensor->lengths_per_target();
    const Index count = is_angle ? found.sensor->rows_per_target() - lengths : lengths;
    return std::sqrt(std::max(0.0, factor * (model + noise) - noise) / static_cast<double>(count));
}

}  // namespace posewise::detail
