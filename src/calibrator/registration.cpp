#include <fmt/format.h>

#include "core/statistics.hpp"
#include "core/text.hpp"
#include "least_squares.hpp"
#include "linear_registration.hpp"
#include "measurement/contact.hpp"
#include "measurement/known_sensor.hpp"
#include "model/sampling.hpp"
#include "part_alone.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/measurement/sensors.hpp"

namespace posewise {
namespace {

VectorXd expected_errors(const Campaign& campaign) {
    const VectorXd& errors = campaign.nominal.robot;
    return errors.size() > 0 ? errors : VectorXd::Zero(campaign.robot.parameter_count());
}

/// Base and sensor are open, the robot is as expected.
Campaign with_expected_robot(const Campaign& campaign) {
    const Chain& robot = campaign.robot;
    const VectorXd errors = expected_errors(campaign);
    if (errors.isZero(0)) return with_robot(campaign, without_parameters(robot));
    const std::vector<bool> all(static_cast<std::size_t>(errors.size()), true);
    return with_robot(campaign, with_known_errors(robot, errors, all));
}

/// What the configurations' means say of the sensor's observed points, one sample each.
Measurements as_points(const Measurements& means, const ObservedPoints& observed) {
    Measurements points = means;
    const Index count = observed.points.count();
    points.observations.resize(means.observations.rows(), 3 * count);
    points.is_seen.resize(means.is_seen.rows(), count);
    const Index targets = means.is_seen.cols();
    const bool are_of_targets = count % targets == 0;
    for (Index i = 0; i < points.observations.rows(); ++i) {
        const VectorXd positions =
            observed.positions(means.observations.row(i).transpose(), means.is_seen.row(i));
        points.is_seen.row(i).setConstant(positions.size() > 0);
        if (positions.size() == 0) continue;
        points.observations.row(i) = positions.transpose();
        for (Index k = 0; k < count && are_of_targets; ++k) {
            points.is_seen(i, k) = means.is_seen(i, k * targets / count);
        }
    }
    return points;
}

detail::RegistrationEquations state_equations(const Campaign& campaign, const Targets& points,
                                              const Measurements& means) {
    const Index unknowns = points.unknown_count();
    const Index rows = 3 * means.is_seen.count();
    detail::RegistrationEquations equations{MatrixXd::Zero(rows, 12 + unknowns), VectorXd(rows)};
    auto& [A, b] = equations;
    Index row = 0;
    for (Index i = 0; i < means.configuration_count(); ++i) {
        const Isometry3d flange = campaign.robot.base_from_flange(
            means.configurations.row(i).transpose(), campaign.nominal.robot);
        for (Index j = 0; j < points.count(); ++j) {
            if (!means.is_seen(i, j)) continue;
            for (Index axis = 0; axis < 3; ++axis) {
                A.block<1, 3>(row + axis, 3 * axis) = means.observation(i, j);
            }
            A.block<3, 3>(row, 9).setIdentity();
            b.segment<3>(row) = flange * points.position(j, VectorXd::Zero(unknowns));
            for (Index axis = 0; axis < 3; ++axis) {
                const Index k = points.unknown_index(j, axis);
                if (k >= 0) A.block<3, 1>(row, 12 + k) = -flange.linear().col(axis);
            }
            row += 3;
        }
    }
    return equations;
}

/// `confused`: parameters that look alike, if it is known.
std::string describe_shortage(const Campaign& campaign, const Measurements& means,
                              const std::vector<Index>& confused = {}) {
    const Sensor& sensor = *campaign.sensor;
    const std::string place = sensor.words().place;
    const Index count = means.configuration_count();
    const std::string what = sensor.has_orientation()
                                 ? detail::these(count, "pose")
                                 : detail::these(count, "configuration") + " with " +
                                       detail::count_of(means.is_seen.count(), "point");
    const std::string alike = confused.empty()
                                  ? ""
                                  : fmt::format(" (the effects of {} cannot be told apart)",
                                                detail::name_parameters(campaign, confused));
    const Unknowable unknowable = find_unknowable(campaign);
    const std::string cure =
        unknowable.parameters.empty()
            ? "more configurations that turn the tool in different ways are needed"
            : fmt::format("no number of them tells {}; what is known must be stated, like {}",
                          detail::list_words(unknowable.parameters),
                          describe_cures(unknowable, campaign));
    return fmt::format("{} {} not determine base and {}{}; {}", what, count == 1 ? "does" : "do",
                       place, alike, cure);
}

/// Says how many views of a camera tell the board's pose, where they are too few.
std::string describe_poor_views(const Seen& is_told) {
    const Index told = is_told.rowwise().any().count();
    return fmt::format(
        "{} of {} show{} enough of the board to tell its pose: 4 corners or more that are not in "
        "one line; more such views are needed",
        told, detail::count_of(is_told.rows(), "view"), told == 1 ? "s" : "");
}

/// Where the polish begins, and by which configurations.
struct Start : Registration {
    std::vector<Index> configurations{};  ///< none: by all
};

/// Those views of a camera that show the board where the others do.
std::vector<Index> find_views(const Campaign& campaign, const ObservedPoints& observed,
                              const Measurements& points) {
    const auto told = points.is_seen.rowwise().any();
    std::vector<Index> views;
    for (Index i = 0; i < told.size(); ++i) {
        if (told[i]) views.push_back(i);
    }
    const auto equations = state_equations(campaign, observed.points, points);
    std::vector<Index> kept;
    for (const Index k : detail::find_consistent(equations, 3 * observed.points.count())) {
        kept.push_back(views[static_cast<std::size_t>(k)]);
    }
    return kept;
}

/// Base and sensor's unknowns that solve the linear equations, the base a rotation.
Start solve_linear(const Campaign& campaign, const ObservedPoints& observed,
                   const Measurements& measured) {
    Measurements means = measured;
    Measurements points = as_points(means, observed);
    const Seen is_told = points.is_seen;
    std::vector<Index> views;
    // Of several cameras each may be the one that is at fault, in whatever views it has; few
    // corners that are not exactly where they are stated tell poses too badly to be compared.
    if (campaign.sensor->has_pixels() && camera_count(*campaign.sensor) == 1 &&
        has_exact_corners(*campaign.sensor)) {
        views = find_views(campaign, observed, points);
        means = take(means, views);
        points = take(points, views);
    }
    const auto equations = state_equations(campaign, observed.points, points);
    if (equations.A.rows() < equations.A.cols()) {
        const bool is_of_views = campaign.sensor->has_pixels();
        return {{campaign.nominal,
                 is_of_views ? describe_poor_views(is_told) : describe_shortage(campaign, means)}};
    }
    const auto free = detail::solve_freely(equations);
    const auto solution = free ? *free : detail::solve_for_rotation(equations);
    Parameters found = campaign.nominal;
    const Matrix3d R = solution.X.transpose();
    found.world_from_base.linear() = R;
    found.world_from_base.translation() = -R * solution.c;
    found.sensor = observed.unknowns(solution.t);
    if (free) return {{found, {}}, views};
    const auto confused = confused_parameters(detail::make_problem(campaign, means), found);
    return {{found, confused.empty() ? "" : describe_shortage(campaign, means, confused)}, views};
}

Start find_start(const Campaign& campaign, const Measurements& measurements);
Registration polish(const Campaign& campaign, const Measurements& measurements, const Start& start,
                    const LevenbergMarquardtOptions& options = {});

/// "sensor 2 (corners)".
std::string name_of(const CombinedSensor& combined, Index part) {
    return fmt::format("sensor {} ({})", part + 1, combined.part(part).sensor->words().readings);
}

/// Each instrument that needs no first guess registers its own base and unknowns alone. The base in
/// the first one's frame is then found by the first that is in a known frame, further frames follow
/// from their own bases. What is found by none begins at its nominal value.
Start find_start_of_parts(const Campaign& campaign, const CombinedSensor& combined,
                          const Measurements& measurements) {
    const auto count = static_cast<std::size_t>(combined.part_count());
    std::vector<VectorXd> unknowns(count);
    std::vector<Isometry3d> frames(count, Isometry3d::Identity());
    std::vector<std::optional<Isometry3d>> bases(count);  // each in its instrument's frame
    std::optional<Isometry3d> base;
    for (std::size_t k = 0; k < count; ++k) {
        unknowns[k] = combined.unknowns_of(static_cast<Index>(k), campaign.nominal.sensor);
        frames[k] = combined.frame(static_cast<Index>(k), campaign.nominal.sensor);
    }
    for (std::size_t k = 0; k < count; ++k) {
        const auto part = static_cast<Index>(k);
        const SensorPart& stated = combined.part(part);
        const detail::PartAlone only =
            detail::take_part(campaign, combined, part, measurements, campaign.nominal);
        // A camera that has found itself by one board needs no more than a view of another.
        const bool is_found = stated.same_camera && combined.has_only_shared_unknowns(part) &&
                              bases[static_cast<std::size_t>(*stated.same_camera)];
        if (is_found) {
            unknowns[k] = combined.unknowns_of(part, combined.unknowns(unknowns, frames));
        }
        const Campaign alone =
            is_found ? detail::with_known_sensor(only.campaign, unknowns[k]) : only.campaign;
        const Measurements& measured = only.measured;
        if (measured.configuration_count() == 0) {
            return {{campaign.nominal,
                     fmt::format("{} shows nothing in any configuration; measure by it, or leave "
                                 "it out of the campaign",
                                 name_of(combined, part))}};
        }
        if (base_parameter_count(alone) < 6 || !stated.sensor->observed_points()) continue;
        const Start start = find_start(alone, measured);
        Registration found = start;
        if (found.is_determined()) found = polish(alone, measured, start);
        if (!found.is_determined()) {
            return {{campaign.nominal, name_of(combined, part) + ": " + found.undetermined}};
        }
        if (!is_found) unknowns[k] = found.parameters.sensor;
        bases[k] = found.parameters.world_from_base;
        if (!base && stated.known_frame) base = *stated.known_frame * *bases[k];
    }
    const auto refuse_unless = [&](bool is_stated, std::size_t k, const char* what) {
        if (is_stated) return;
        throw InputError(fmt::format(
            "{} of {} cannot be found from nothing; the campaign must state it, if only roughly "
            "(keys of sensors[{}])",
            what, name_of(combined, static_cast<Index>(k)), k + 1));
    };
    Parameters start = campaign.nominal;
    if (base) start.world_from_base = *base;
    if (!base && base_parameter_count(campaign) > 0 && !campaign.has_nominal_base) {
        throw InputError(fmt::format(
            "the base in the frame of {} cannot be found from nothing; the campaign must state it, "
            "if only roughly (key base)",
            name_of(combined, 0)));
    }
    for (std::size_t k = 0; k < count; ++k) {
        const SensorPart& stated = combined.part(static_cast<Index>(k));
        if (!bases[k]) {
            refuse_unless(unknowns[k].size() == 0 || stated.has_nominal_unknowns, k,
                          "what is unknown");
        }
        if (stated.known_frame) continue;
        if (!bases[k]) refuse_unless(stated.has_nominal_frame, k, "the frame");
        if (bases[k]) frames[k] = start.world_from_base * bases[k]->inverse();
    }
    start.sensor = combined.unknowns(unknowns, frames);
    return {{std::move(start), {}}};
}

/// The robot has no parameters.
Start find_start(const Campaign& campaign, const Measurements& measurements) {
    const Sensor& sensor = *campaign.sensor;
    std::string unseen = detail::describe_unseen_target(campaign, measurements);
    if (!unseen.empty()) return {{campaign.nominal, std::move(unseen)}};
    if (const auto* const combined = dynamic_cast<const CombinedSensor*>(&sensor)) {
        return find_start_of_parts(campaign, *combined, measurements);
    }
    if (base_parameter_count(campaign) == 6) {
        const Measurements means = mean_measurements(sensor, measurements);
        if (const auto observed = sensor.observed_points(means)) {
            return solve_linear(campaign, *observed, means);
        }
    }
    const bool is_found_anyway = base_parameter_count(campaign) == 0 && !sensor.needs_first_guess();
    if (!is_found_anyway && (!campaign.has_nominal_base || !campaign.has_nominal_targets)) {
        throw InputError(fmt::format(
            "base and targets cannot be found from nothing by {} alone or beside a base that is "
            "partly known; the campaign must state base and targets, if only roughly (keys base "
            "and {})",
            sensor.observed_points() ? "lengths" : sensor.words().readings, sensor.words().key));
    }
    return {{campaign.nominal, {}}};
}

/// Those that are missed by no more than some times what most of `by` are.
std::vector<Index> find_near(const Campaign& campaign, const Measurements& measurements,
                             const Parameters& parameters, const std::vector<Index>& by) {
    constexpr double far = 8;
    const VectorXd all =
        (squared_angles(campaign, parameters, measurements).rowwise().sum().array() /
         times_seen(measurements).cwiseMin(1).rowwise().sum().array().max(1))
            .sqrt();
    const double most = far * detail::quantile(all(by), 0.5, detail::QuantileRule::Upper);
    std::vector<Index> near;
    for (Index i = 0; i < all.size(); ++i) {
        if (all[i] <= most) near.push_back(i);
    }
    return near;
}

/// On the true residuals of the start's configurations, then of all that are near.
Registration polish(const Campaign& campaign, const Measurements& measurements, const Start& start,
                    const LevenbergMarquardtOptions& options) {
    const std::vector<Index>& by = start.configurations;
    const auto polish_by = [&](const Measurements& some, const Parameters& from) {
        Estimate polished = identify(campaign, some, from, options);
        return Registration{std::move(polished.parameters), std::move(polished.undetermined)};
    };
    if (by.empty() || std::ssize(by) == measurements.configuration_count()) {
        return polish_by(measurements, start.parameters);
    }
    const Registration by_some = polish_by(take(measurements, by), start.parameters);
    if (!by_some.is_determined()) return by_some;
    const auto near = find_near(campaign, measurements, by_some.parameters, by);
    return near == by ? by_some : polish_by(take(measurements, near), by_some.parameters);
}

/// What a prior leaves open of base and sensor, as if what it tells were known.
Campaign beside(const Prior& prior, Campaign campaign) {
    const VectorXd told = campaign.nominal.sensor;
    campaign.prior.reset();
    if (prior.has_base) campaign.base_is_known.fill(true);
    return prior.has_sensor ? detail::with_known_sensor(std::move(campaign), told) : campaign;
}

/// Where a prior expects them, what it tells of base and sensor; the rest registered beside it.
Registration register_beside(const Prior& prior, const Campaign& campaign,
                             const Measurements& measurements) {
    const Parameters& told = campaign.nominal;
    if (prior.has_base && prior.has_sensor) return {told, {}};
    Registration registered = register_base_and_targets(beside(prior, campaign), measurements);
    if (prior.has_sensor) registered.parameters.sensor = told.sensor;
    return registered;
}

/// Whether it tells enough of base and sensor to begin at what it expects.
bool can_begin_at(const Prior& prior, const Campaign& campaign) {
    return prior.has_sensor || (prior.has_base && campaign.has_nominal_targets);
}

}  // namespace

Registration register_roughly(const Campaign& campaign, const Measurements& measurements) {
    Registration start = find_start(with_expected_robot(campaign), measurements);
    start.parameters.robot = expected_errors(campaign);
    return start;
}

Registration register_base_and_targets(const Campaign& campaign, const Measurements& measurements) {
    return register_base_and_targets(campaign, measurements, {});
}

Registration register_base_and_targets(const Campaign& campaign, const Measurements& measurements,
                                       const LevenbergMarquardtOptions& options) {
    const Campaign expected = with_expected_robot(campaign);
    const Start start = find_start(expected, measurements);
    Registration registered = start;
    if (registered.is_determined()) {
        registered = polish(expected, measurements, start, options);
    }
    const auto& prior = campaign.prior;
    if (!registered.is_determined() && prior && can_begin_at(*prior, campaign)) {
        registered = register_beside(*prior, campaign, measurements);
    }
    registered.parameters.robot = expected_errors(campaign);
    return registered;
}

Index least_calibration_count(const Campaign& campaign, const StopSignal& stop) {
    if (campaign.prior && can_begin_at(*campaign.prior, campaign)) {
        const Campaign open = beside(*campaign.prior, campaign);
        const bool is_all_told = base_parameter_count(open) == 0 && open.nominal.sensor.size() == 0;
        return is_all_told ? 1 : least_calibration_count(open, stop);
    }
    const Index least = std::max(least_pose_count(campaign, stop), campaign.fitted_pose_count);
    const Campaign nominal = with_robot(campaign, without_parameters(campaign.robot));
    if (base_parameter_count(nominal) < 6) return least;
    const std::optional<ObservedPoints> observed = nominal.sensor->observed_points();
    if (!observed) return least;
    constexpr std::uint64_t seed = 20152;  // any: it only has to be the same every time
    // More than as many as there are unknowns do not help: what is open then is open always.
    const Index most = least + 12 + observed->points.unknown_count();
    RowMatrixXd in_view;  // a camera learns nothing from poses that do not show it the board
    if (nominal.sensor->has_view()) {
        in_view = detail::viewed_poses(nominal, nominal.nominal, most, seed).configurations;
    }
    const auto are_enough = [&](Index count) {
        const RowMatrixXd drawn = in_view.rows() > 0
                                      ? RowMatrixXd(in_view.topRows(count))
                                      : detail::random_configurations(nominal.robot, count, seed);
        const auto measured = simulate_measurements(nominal, nominal.nominal, drawn, 1, seed);
        return register_roughly(nominal, measured).is_determined();
    };
    for (Index count = least; count < most; ++count) {
        if (count > least) stop.check("finding how many poses register base and targets");
        if (are_enough(count)) return count;
    }
    return least;
}

Parameters determined(Registration registration) {
    if (!registration.is_determined()) throw InputError(registration.undetermined);
    return std::move(registration.parameters);
}

}  // namespace posewise
