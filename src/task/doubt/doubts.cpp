#include "posewise/task/doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absurd_values.hpp"
#include "calibrator/missing_errors.hpp"
#include "calibrator/model_error.hpp"
#include "calibrator/part_alone.hpp"
#include "core/format.hpp"
#include "gross_errors.hpp"
#include "model/joint_limits.hpp"
#include "plane_doubts.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/model/error_terms.hpp"
#include "posewise/planner/planning.hpp"
#include "residual_ratio.hpp"

namespace posewise {
namespace {

/// Times the expected size: a joint with a wrong sign may converge as well, with an offset of half
/// a turn.
constexpr double doubtful_size = 20;
/// A prior holds values back: beyond it, it is wrong or the model is.
constexpr double doubtful_under_prior = 3;

/// What no robot has, in expected sizes (real ones that were measured have ten at most), and no
/// measurement, in standard deviations as stated.
constexpr double incredible_size = 50;
constexpr double incredible_deviation = 100;  // of a value, in its expected sizes
constexpr double incredible_residuals = 300;
/// A joint whose zero is off by more was meant otherwise.
constexpr double incredible_offset = 10 * std::numbers::pi / 180;
constexpr double incredible_offset_size = 5;

std::vector<ResidualDoubt> find_residual_doubts(const Campaign& campaign,
                                                const Measurements& measured,
                                                const Estimate& estimate) {
    const Campaign found = with_model_error(campaign, estimate);
    std::vector<ResidualDoubt> doubts;
    for (const bool is_angle : {false, true}) {
        const Sensor& sensor = *campaign.sensor;
        if (!(is_angle ? sensor.has_angles() : sensor.has_lengths())) continue;
        if (const auto ratio =
                detail::clear_ratio(estimate.variance_of(is_angle), estimate.loss.kind)) {
            const ExpectedError expected = expected_error(found, estimate, measured, is_angle);
            doubts.push_back(
                {*ratio, is_angle,
                 is_angle && found.sensor->has_pixels()
                     ? 0
                     : detail::fitting_model_error(found, estimate, expected, is_angle)});
        }
    }
    return doubts;
}

std::optional<double> find_small_residuals(const Campaign& campaign, const Estimate& estimate) {
    constexpr double other_unit = 0.02;
    constexpr double large_model_error = 5e-3;  // m
    if (estimate.degrees_of_freedom <= 0) return std::nullopt;
    const double found = campaign.model_error > large_model_error
                             ? std::min(1.0, estimate.model_error / campaign.model_error)
                             : 1;
    const double ratio = found * std::sqrt(estimate.variance_factor);
    if (ratio >= other_unit) return std::nullopt;
    return ratio;
}

std::vector<SizeDoubt> find_size_doubts(const Campaign& campaign, const Estimate& estimate) {
    const VectorXd& errors = estimate.parameters.robot;
    const Index robot_begin = base_parameter_count(campaign);
    const VectorXd times =
        errors.cwiseQuotient(robot_error_sizes(campaign.spread, campaign.robot)).cwiseAbs();
    std::vector<SizeDoubt> doubts;
    for (Index k = 0; k < times.size(); ++k) {
        if (times[k] <= (campaign.spread.is_prior ? doubtful_under_prior : doubtful_size)) continue;
        doubts.push_back({estimate.names[static_cast<std::size_t>(robot_begin + k)], times[k],
                          errors[k], &units_of(campaign.robot.parameter_element(k).motion),
                          campaign.robot.parameter_term(k) != nullptr});
    }
    const VectorXd of_sensor = campaign.sensor->unknown_sizes();
    const auto units = campaign.sensor->unknown_units();
    const Index sensor_begin = robot_begin + errors.size();
    for (Index k = 0; k < of_sensor.size(); ++k) {
        const double error = estimate.parameters.sensor[k];
        const double ratio = std::abs(error) / of_sensor[k];
        if (ratio <= doubtful_under_prior) continue;
        doubts.push_back({estimate.names[static_cast<std::size_t>(sensor_begin + k)], ratio, error,
                          units[static_cast<std::size_t>(k)]});
    }
    return doubts;
}

/// Classes whose sizes were learned far above the expected ones.
std::vector<SizeDoubt> find_class_doubts(const Campaign& campaign, const Estimate& estimate) {
    constexpr double doubtful = error_size_factor * error_size_factor * error_size_factor;
    std::vector<SizeDoubt> doubts;
    if (!estimate.spread) return doubts;
    const std::vector<SharedSize> learned = shared_sizes(*estimate.spread, campaign.robot);
    const std::vector<SharedSize> expected = shared_sizes(campaign.spread, campaign.robot);
    for (std::size_t k = 0; k < learned.size(); ++k) {
        const double times = learned[k].size / expected[k].size;
        if (times <= doubtful) continue;
        doubts.push_back({"spread." + learned[k].key, times, learned[k].size,
                          &units_of(learned[k].is_angle),
                          campaign.robot.parameter_term(learned[k].members.front()) != nullptr});
    }
    return doubts;
}

std::vector<ModelErrorDoubt> find_model_error_doubts(const Campaign& campaign,
                                                     const Estimate& estimate) {
    constexpr double doubtful = model_error_factor * model_error_factor;
    std::vector<ModelErrorDoubt> doubts;
    const auto add = [&](double found, double expected, bool is_angle) {
        const bool is_limit = found >= detail::most_model_errors * expected;
        if (found > doubtful * expected) {
            doubts.push_back({found / expected, found, is_angle, is_limit});
        }
    };
    add(estimate.model_error, campaign.model_error, false);
    add(estimate.model_error_orientation, campaign.model_error_orientation, true);
    return doubts;
}

std::optional<double> find_missing_errors(const Campaign& campaign, const Measurements& measured,
                                          const Estimate& estimate) {
    const Campaign found = with_model_error(campaign, estimate);
    detail::IdentificationProblem problem = detail::make_problem(found, measured);
    problem.loss = estimate.loss;
    problem.deviation = std::sqrt(estimate.variance_factor);
    constexpr double of_no_consequence = 0.05;
    const double share = detail::missing_errors(problem, estimate.parameters);
    if (share <= of_no_consequence) return std::nullopt;
    return share;
}

std::vector<Index> find_negative_compliances(const Campaign& campaign, const Estimate& estimate) {
    constexpr double significant = 3;  // standard deviations
    const VectorXd sigmas = standard_deviations(estimate);
    const Index robot_begin = base_parameter_count(campaign);
    std::vector<Index> joints;
    for (const Compliance& compliance : compliances(campaign.robot)) {
        const Index k = compliance.parameter;
        if (estimate.parameters.robot[k] > -significant * sigmas[robot_begin + k]) continue;
        joints.push_back(compliance.joint);
    }
    return joints;
}

}  // namespace

std::optional<BeyondLimits> find_beyond_limits(const Campaign& campaign,
                                               const RowMatrixXd& configurations) {
    BeyondLimits beyond;
    for (Index i = 0; i < configurations.rows(); ++i) {
        std::string violation =
            detail::describe_limit_violation(campaign.robot, configurations.row(i).transpose());
        if (violation.empty()) continue;
        if (++beyond.count > 1) continue;
        beyond.first = i;
        beyond.violation = std::move(violation);
    }
    if (beyond.count == 0) return std::nullopt;
    return beyond;
}

std::vector<Index> find_still_joints(const Campaign& campaign, const RowMatrixXd& configurations) {
    constexpr double still = 1e-6;  // rad or m
    std::vector<Index> joints;
    for (Index j = 0; j < campaign.robot.joint_count() && configurations.rows() > 1; ++j) {
        const auto q = configurations.col(j);
        if (q.maxCoeff() - q.minCoeff() <= still) joints.push_back(j);
    }
    return joints;
}

std::vector<std::string> find_faults(const Campaign& campaign, const Estimate& estimate,
                                     ValueCheck values) {
    std::vector<std::string> faults;
    if (estimate.ending != Ending::Converged && estimate.ending != Ending::RoundoffLimited) {
        faults.push_back(fmt::format("it did not converge ({})", ending_name(estimate.ending)));
    }
    const double ratio = detail::times_stated(campaign, estimate);
    if (!(ratio <= incredible_residuals)) {
        faults.push_back(fmt::format("its residuals are {} times what sigma and model error say",
                                     detail::format_short(ratio, 2)));
    }
    if (values == ValueCheck::None) return faults;
    for (const auto& [plane, angle] :
         detail::find_turned_planes(campaign, estimate.parameters.sensor)) {
        faults.push_back(fmt::format("plane {} is turned by {} deg from the normal stated of it",
                                     plane + 1, detail::format_short(to_degrees(angle), 2)));
    }
    const VectorXd scale = parameter_scale(campaign);
    const VectorXd sigmas = standard_deviations(estimate);
    const Index robot_begin = base_parameter_count(campaign);
    const auto add = [&](Index k, double value, const char* what, double most, bool is_offset) {
        const double times = std::abs(value) / scale[robot_begin + k];
        const bool is_angle = campaign.robot.parameter_element(k).motion == Motion::Rotation;
        const bool is_turned = is_offset && is_angle && times > incredible_offset_size &&
                               std::abs(value) > incredible_offset;
        if (times <= most && !is_turned) return;
        faults.push_back(fmt::format("{}{} is {} {}, {} times the size expected of it", what,
                                     estimate.names[static_cast<std::size_t>(robot_begin + k)],
                                     detail::format_short(1e3 * value, 4), units_of(is_angle).error,
                                     detail::format_short(times, 2)));
    };
    for (Index k = 0; k < estimate.parameters.robot.size(); ++k) {
        const bool is_offset = !campaign.robot.parameter_element(k).joints.empty() &&
                               campaign.robot.parameter_term(k) == nullptr;
        add(k, estimate.parameters.robot[k], "", incredible_size, is_offset);
        add(k, sigmas[robot_begin + k], "the standard deviation of ", incredible_deviation, false);
    }
    detail::add_absurd_values(campaign, estimate, faults);
    return faults;
}

Doubts find_doubts(const Campaign& campaign, const Measurements& measurements,
                   const Parameters& registered, const Metrics& nominal) {
    Doubts doubts;
    if (campaign.sensor->has_only_pixels()) {
        doubts.misfit = find_misfit(campaign, measurements, registered);
        const auto& misfit = doubts.misfit;
        if (misfit && misfit->is_explained()) return doubts;  // all else follows from it
        // Rows of other poses also look like views of another place, or a board of another size.
        if (misfit) doubts.look.shifted = find_shifted_rows(campaign, measurements);
        if (doubts.look.shifted) return doubts;
    }
    const auto parts = detail::parts_alone(campaign, measurements, registered);
    for (const detail::PartAlone& part : parts) {
        for (ViewDoubt& view : find_view_doubts(part.campaign, part.measured, part.registered)) {
            doubts.views.push_back(std::move(view));
        }
    }
    std::vector<std::string> views;
    for (const ViewDoubt& view : doubts.views) {
        if (std::ranges::find(views, view.sample) == views.end()) views.push_back(view.sample);
    }
    const Measurements measured = leave_out(measurements, views);
    doubts.camera = find_camera_doubt(campaign, measured, registered);
    if (doubts.camera && doubts.camera->board_factor != 1) {
        doubts.misfit.reset();
    } else if (doubts.camera && doubts.misfit) {
        doubts.camera->scatter = 0;  // about a camera that is elsewhere
    } else if (!campaign.sensor->has_only_pixels()) {
        doubts.misfit = find_misfit(campaign, measured, registered);
    }
    if (!doubts.misfit) {
        for (const detail::PartAlone& part : parts) {
            if (doubts.planes.empty()) {
                doubts.planes = find_plane_doubts(part.campaign, part.measured);
            }
        }
        doubts.places = find_place_doubts(campaign, registered);
    }
    if (nominal.distance_rms > detail::gross_distance) doubts.gross_error = nominal.distance_rms;
    if (campaign.sensor->has_orientation() && nominal.orientation_rms > detail::gross_angle) {
        doubts.orientations = nominal.orientation_rms;
    }
    return doubts;
}

void add_doubts(const Campaign& campaign, const Measurements& measured, const Estimate& estimate,
                Doubts& doubts) {
    doubts.sizes = find_size_doubts(with_model_error(campaign, estimate), estimate);
    doubts.learned_sizes = find_class_doubts(campaign, estimate);
    doubts.model_errors = find_model_error_doubts(campaign, estimate);
    doubts.residuals = find_residual_doubts(campaign, measured, estimate);
    doubts.small_residuals = find_small_residuals(campaign, estimate);
    doubts.missing_errors = find_missing_errors(campaign, measured, estimate);
    doubts.scatter = find_scatter_doubt(campaign, measured, estimate.parameters);
    doubts.lacks_length = lacks_length(campaign, measured);
    doubts.distance = find_distance_doubt(campaign, measured, estimate);
    doubts.negative_compliances = find_negative_compliances(campaign, estimate);
}

}  // namespace posewise
