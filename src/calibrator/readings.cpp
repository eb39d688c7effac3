#include "readings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "core/parallel.hpp"
#include "core/progress_counter.hpp"
#include "core/statistics.hpp"
#include "length_units.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

/// So many readings, the best of the quick registration, are registered properly.
constexpr std::size_t polished_count = 64;

/// Evenly spaced configurations, or all where a target is seen only in the others.
Measurements thin_out(const Measurements& measurements, Index most) {
    const Index count = measurements.configuration_count();
    if (count <= most) return measurements;
    Measurements some = take(measurements, evenly_spaced(count, most));
    const auto shown = [](const Measurements& all) { return all.is_seen.colwise().any().count(); };
    return shown(some) < shown(measurements) ? measurements : some;
}

/// How much farther the measured points of a target spread than the flange, by the joints, does.
double measured_extent(const Campaign& campaign, const Measurements& measured) {
    const VectorXd no_errors = VectorXd::Zero(campaign.robot.parameter_count());
    RowMatrixXd flange(measured.configuration_count(), 3);
    for (Index i = 0; i < flange.rows(); ++i) {
        const VectorXd q = measured.configurations.row(i).transpose();
        flange.row(i) =
            campaign.robot.base_from_links(q, no_errors).back().translation().transpose();
    }
    RowMatrixXd seen(measured.is_seen.rows(), 3);
    Index count = 0;
    for (Index sample = 0; sample < seen.rows(); ++sample) {
        if (!measured.is_seen(sample, 0)) continue;
        seen.row(count++) = measured.observation(sample, 0).head<3>();
    }
    return rms_spread(seen.topRows(count)) / rms_spread(flange);
}

/// With which the measured points spread about as the flange does.
double likely_length_factor(const Campaign& campaign, const Measurements& measured) {
    if (campaign.sensor->lengths_per_target() != 3 || campaign.sensor->is_combined()) return 1;
    const double extent = measured_extent(campaign, measured);
    constexpr double tolerated = 4;  // targets beside the flange move farther
    if (!(extent > tolerated) && !(extent < 1 / tolerated && extent > 0)) return 1;
    return nearest_length_factor(1 / extent);
}

/// Whether corners are in the image, but for a few that noise has moved out of it.
bool is_in_image(const ReadingChanges& changes, const Campaign& campaign,
                 const Measurements& measured) {
    constexpr double few = 0.02;
    if (!has_kind(changes, ReadingChange::Kind::Image)) return true;
    const Measurements meant = read_with(changes, campaign, measured);
    Index outside = 0;
    for (Index sample = 0; sample < meant.is_seen.rows(); ++sample) {
        for (const Index target : targets_seen(meant.is_seen.row(sample))) {
            const auto observation = meant.observations.row(sample).transpose();
            if (!campaign.sensor->is_readable(target, observation)) ++outside;
        }
    }
    return static_cast<double>(outside) <= few * static_cast<double>(meant.is_seen.count());
}

/// Degrees read as rad go beyond a turn, and mm read as m beyond any rail. Taken as such smaller
/// values would let the robot hardly move: then points that hardly move fit, whatever they are.
bool is_possible(const ReadingChanges& changes, const Campaign& campaign,
                 const Measurements& measured) {
    constexpr double turn = 2 * std::numbers::pi;
    constexpr double rail = 20;  // m
    for (const ReadingChange& change : changes) {
        if (change.kind != ReadingChange::Kind::JointFactor || change.factor > 1) continue;
        double largest = 0;  // in turns or rails
        for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
            const bool turns = campaign.robot.joint(j).motion == Motion::Rotation;
            if (change.joint < 0 ? !turns : j != change.joint) continue;
            const double value = measured.configurations.col(j).cwiseAbs().maxCoeff();
            largest = std::max(largest, value / (turns ? turn : rail));
        }
        if (largest <= 1) return false;
    }
    return true;
}

using Register = Registration (&)(const Campaign&, const Measurements&);

/// Infinite where the tool, moved so, does not turn in enough ways.
void fit(const Campaign& campaign, const Measurements& measurements, Register registers,
         FittedReading& reading) {
    reading.distance_rms = reading.misfit = std::numeric_limits<double>::infinity();
    const Measurements meant =
        mean_measurements(*campaign.sensor, read_with(reading.changes, campaign, measurements));
    const Registration registered = registers(campaign, meant);
    if (!registered.is_determined()) return;
    const RowMatrixXd left = residuals(campaign, registered.parameters, meant);
    const Index lengths = campaign.sensor->lengths_per_target();
    const Metrics metrics = make_metrics(left, lengths);
    reading.distance_rms = metrics.distance_rms;
    reading.orientation_rms = metrics.orientation_rms;
    const auto judged = left.leftCols(lengths > 0 ? lengths : left.cols());
    reading.median = quantile(judged.rowwise().norm(), 0.5, QuantileRule::Upper);
    constexpr double lever = 1;  // m
    reading.misfit = std::hypot(metrics.distance_rms, lever * metrics.orientation_rms);
}

/// What fits has converged by then; what does not would go on for long. What the model's error is
/// hardly moves base and targets.
Registration register_quickly(const Campaign& campaign, const Measurements& measurements) {
    LevenbergMarquardtOptions options;
    options.iteration_limit = 30;
    options.finds_model_error = false;
    return register_base_and_targets(campaign, measurements, options);
}

Index changes_of(const FittedReading& reading) { return count_changes(reading.changes); }

/// Registers them with polish, some at a time and the best first: where what is polished leaves far
/// less already, the others are left as they are. To polish what does not fit takes long.
void polish(const std::span<FittedReading>& readings, const Campaign& campaign,
            const Measurements& measurements, ProgressCounter& counter) {
    constexpr std::size_t at_once = 16;
    constexpr double hopeless = 300;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t begin = 0; begin < readings.size(); begin += at_once) {
        const auto some = readings.subspan(begin, std::min(at_once, readings.size() - begin));
        for_each_index(std::ssize(some), [&](Index k) {
            FittedReading& reading = some[static_cast<std::size_t>(k)];
            const bool is_near = begin == 0 || !(reading.misfit > hopeless * best);
            if (is_near) fit(campaign, measurements, register_quickly, reading);
            counter.count();
        });
        best = std::min(best, std::ranges::min(some, {}, &FittedReading::misfit).misfit);
    }
}

/// A dozen corners tell as well as all whether an image is of a board; which they are fits no row
/// and no column of it.
Measurements with_few_corners(const Sensor& sensor, Measurements measurements) {
    constexpr Index enough = 12;
    const Index count = measurements.is_seen.cols();
    if (!sensor.has_only_pixels() || count <= enough) return measurements;
    std::vector<Index> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), Index{0});
    const auto place = [](Index k) {
        return std::fmod(static_cast<double>(k) * (std::numbers::phi - 1), 1);
    };
    std::ranges::sort(order, {}, place);
    for (Index sample = 0; sample < measurements.is_seen.rows(); ++sample) {
        Index kept = 0;
        for (const Index k : order) {
            if (measurements.is_seen(sample, k) && ++kept > enough) {
                measurements.is_seen(sample, k) = false;
            }
        }
    }
    return measurements;
}

}  // namespace

FittedReadings fit_readings(const Campaign& campaign, const Measurements& measurements,
                            Index most_configurations, const ProgressCallback& progress) {
    const Measurements thinned =
        with_few_corners(*campaign.sensor, thin_out(measurements, most_configurations));
    // What is wrong with the measurements themselves is said once, of the robot as stated.
    FittedReadings fitted;
    try {
        fitted.undetermined = register_roughly(campaign, thinned).undetermined;
    } catch (const InputError& error) {  // few corners of few views may link no two cameras
        fitted.undetermined = error.what();
    }
    if (!fitted.undetermined.empty()) return fitted;
    std::vector<FittedReading>& readings = fitted.readings;
    for (ReadingChanges& changes :
         all_readings(campaign, measurements.notation, likely_length_factor(campaign, thinned))) {
        if (!is_possible(changes, campaign, thinned) || !is_in_image(changes, campaign, thinned)) {
            continue;
        }
        readings.push_back({std::move(changes)});
    }
    const std::size_t polished = std::min(polished_count, readings.size());
    ProgressCounter counter(progress, static_cast<Index>(readings.size() + polished));
    for_each_index(std::ssize(readings), [&](Index k) {
        fit(campaign, thinned, register_roughly, readings[static_cast<std::size_t>(k)]);
        counter.count();
    });
    std::ranges::stable_sort(readings, {}, &FittedReading::misfit);
    const auto stated = std::ranges::find(readings, 0, changes_of);
    std::rotate(readings.begin(), stated, stated + 1);  // polished first
    const std::span best(readings.begin(), polished);
    polish(best, campaign, thinned, counter);
    std::ranges::stable_sort(best, {}, &FittedReading::misfit);
    const auto end = std::ranges::find_if_not(
        readings, [&](const auto& reading) { return fit_alike(reading, readings.front()); });
    std::ranges::stable_sort(readings.begin(), end, {}, changes_of);
    return fitted;
}

bool fit_alike(const FittedReading& reading, const FittedReading& other) {
    constexpr double tolerated = 1.001;
    return reading.misfit <= tolerated * other.misfit && other.misfit <= tolerated * reading.misfit;
}

const FittedReading& as_stated(const std::vector<FittedReading>& readings) {
    return *std::ranges::find(readings, 0, changes_of);
}

const FittedReading* find_clearly_better(const std::vector<FittedReading>& readings,
                                         double credible) {
    constexpr double far = 0.5;
    constexpr double clearly = 1.5;
    const double best = readings.front().misfit;
    const double stated = as_stated(readings).misfit;
    // The simplest of those that fit about as well as the best.
    const FittedReading* simplest = nullptr;
    bool is_alone = true;
    for (const FittedReading& reading : readings) {
        if (!(reading.misfit <= clearly * best)) break;
        if (simplest == nullptr || changes_of(reading) < changes_of(*simplest)) {
            simplest = &reading;
            is_alone = true;
        } else if (changes_of(reading) == changes_of(*simplest)) {
            is_alone = is_alone && fit_alike(reading, *simplest);
        }
    }
    if (simplest == nullptr || !is_alone) return nullptr;
    const bool is_better = simplest->misfit < far * stated && simplest->median <= credible;
    return is_better ? simplest : nullptr;
}

}  // namespace posewise::detail
