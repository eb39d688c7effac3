#include "absurd_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/format.hpp"
#include "measurement/places.hpp"
#include "posewise/core/types.hpp"

namespace posewise::detail {
namespace {

constexpr double largest_model_error = 0.1;  // m, rad
/// m^2, rad^2, or a variance factor: measurements without any noise leave 1e-34 and less, since
/// numbers have 16 digits.
constexpr double least_variance = 1e-42;

void add_model_error(double error, bool is_angle, std::vector<std::string>& faults) {
    if (error <= largest_model_error) return;
    faults.push_back(fmt::format("its model error is {} {}, above the {} {} of any robot",
                                 format_short(1e3 * error, 4), units_of(is_angle).error,
                                 1e3 * largest_model_error, units_of(is_angle).error));
}

/// A statement in another unit is none of the estimate's faults, nor is an origin far away.
void add_base(const Campaign& campaign, const Vector3d& found, std::vector<std::string>& faults) {
    const Vector3d stated = campaign.nominal.world_from_base.translation();
    const bool is_as_stated = campaign.has_nominal_base && (found - stated).norm() <= farthest_base;
    if (is_as_stated || found.norm() <= farthest_base) return;
    faults.push_back(fmt::format("the base is {} m from the instrument, above 1000 m",
                                 format_short(found.norm(), 4)));
}

void add_targets(const Targets& targets, const VectorXd& unknowns,
                 std::vector<std::string>& faults) {
    for (Index k = 0; k < targets.count(); ++k) {
        const Vector3d place = targets.position(k, unknowns);
        if (place.norm() > farthest_target) {
            faults.push_back(fmt::format("target {} is {} m from the flange, above 10 m", k + 1,
                                         format_short(place.norm(), 4)));
        }
        for (Index i = 0; i < k; ++i) {
            const double distance = (place - targets.position(i, unknowns)).norm();
            if (distance >= nearest_targets) continue;
            faults.push_back(fmt::format("targets {} and {} are at one place, {} mm apart", i + 1,
                                         k + 1, format_short(mm_per_m * distance, 2)));
        }
    }
}

/// Of parameters; 0 of the base or of the sensor's unknowns, if all are 0, is that of what was
/// moved.
void add_variances(const Campaign& campaign, const Estimate& estimate,
                   std::vector<std::string>& faults) {
    const VectorXd variances = estimate.covariance.diagonal();
    const Index of_sensor = estimate.parameters.sensor.size();
    const Index of_base = base_parameter_count(campaign);
    const bool has_moved = variances.tail(of_sensor).isZero(0);
    const bool has_moved_base = variances.head(of_base).isZero(0);
    const auto units = parameter_units(campaign);
    const Index end = variances.size() - (has_moved ? of_sensor : 0);
    for (Index k = has_moved_base ? of_base : 0; k < end; ++k) {
        if (variances[k] >= least_variance) continue;
        const auto i = static_cast<std::size_t>(k);
        faults.push_back(
            fmt::format("the standard deviation of {} is {:.2g} {}, which no "
                        "measurement gives",
                        estimate.names[i], 1e3 * std::sqrt(variances[k]), units[i]->error));
    }
}

/// Without degrees of freedom nothing is known of it, and it is 1.
void add_variance_factor(const Estimate& estimate, std::vector<std::string>& faults) {
    const double factor = estimate.variance_factor;
    if (estimate.degrees_of_freedom == 0 && factor != 1) {
        faults.push_back(
            fmt::format("its variance factor is {:.4g}, of no degrees of freedom", factor));
    } else if (factor < least_variance) {
        faults.push_back(
            fmt::format("its variance factor is {:.2g}, which no measurement gives", factor));
    }
}

}  // namespace

double times_stated(const Campaign& stated, const Estimate& estimate) {
    constexpr double beyond = 2;
    double largest = std::sqrt(estimate.variance_factor);
    const auto add = [&](bool is_angle, double found, double expected) {
        const double ratio = std::sqrt(estimate.variance_of(is_angle).factor);
        largest = std::max(largest, ratio);
        if (ratio > beyond && found > expected && expected > 0) {
            largest = std::max(largest, found / expected * ratio);
        }
    };
    const Sensor& sensor = *stated.sensor;
    if (sensor.has_lengths()) add(false, estimate.model_error, stated.model_error);
    if (sensor.has_angles()) {
        add(true, estimate.model_error_orientation, stated.model_error_orientation);
    }
    return largest;
}

void add_absurd_values(const Campaign& campaign, const Estimate& estimate,
                       std::vector<std::string>& faults) {
    add_model_error(estimate.model_error, false, faults);
    add_model_error(estimate.model_error_orientation, true, faults);
    add_base(campaign, estimate.parameters.world_from_base.translation(), faults);
    add_targets(campaign.sensor->targets(), estimate.parameters.sensor, faults);
    add_variances(campaign, estimate, faults);
    add_variance_factor(estimate, faults);
}

}  // namespace posewise::detail
