#include "earlier_estimate.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "calibrator/learned_sizes.hpp"
#include "calibrator/model_error.hpp"
#include "core/text.hpp"
#include "measurement/known_sensor.hpp"
#include "model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"
#include "task/doubt/residual_ratio.hpp"

namespace posewise {
namespace {

using detail::KnownParameters;

std::vector<Index> numbers_of(const std::vector<bool>& marks, bool wanted) {
    std::vector<Index> numbers;
    for (std::size_t k = 0; k < marks.size(); ++k) {
        if (marks[k] == wanted) numbers.push_back(static_cast<Index>(k));
    }
    return numbers;
}

/// Of all parameters of the campaign.
std::vector<bool> mark_known(const Campaign& campaign, const KnownParameters& known) {
    std::vector<bool> marks(static_cast<std::size_t>(base_parameter_count(campaign)), known.base);
    marks.insert(marks.end(), known.robot.begin(), known.robot.end());
    marks.resize(static_cast<std::size_t>(parameter_count(campaign)), known.targets);
    return marks;
}

/// The covariance of what was known then, a year or so later.
MatrixXd drifted(const Campaign& campaign, const Earlier& earlier) {
    MatrixXd covariance = earlier.estimate.covariance;
    const Drift& drift = earlier.use.drift;
    const Index begin = base_parameter_count(campaign);
    for (Index k = 0; k < campaign.robot.parameter_count(); ++k) {
        const Element& element = campaign.robot.parameter_element(k);
        const bool is_offset =
            !element.joints.empty() && campaign.robot.parameter_term(k) == nullptr;
        const double change = element.motion == Motion::Translation ? drift.length
                              : is_offset                           ? drift.offset
                                                                    : drift.angle;
        covariance(begin + k, begin + k) += change * change;
    }
    return covariance;
}

/// Of `reduced`, the campaign less what is known.
Prior make_prior(const Campaign& campaign, const Campaign& reduced, const Earlier& earlier,
                 const KnownParameters& known) {
    Prior prior{reduced.nominal, !earlier.use.has_new_base, !earlier.use.has_new_targets, {}};
    std::vector<Index> told = numbers_of(mark_known(campaign, known), false);
    if (earlier.use.has_new_targets) {
        told.resize(told.size() - static_cast<std::size_t>(reduced.nominal.sensor.size()));
    }
    if (earlier.use.has_new_base)
        told.erase(told.begin(), told.begin() + base_parameter_count(reduced));
    const auto count = static_cast<Index>(told.size());
    const MatrixXd of_estimate = drifted(campaign, earlier)(told, told);
    // Whatever is on the flange now is known as it is stated.
    const VectorXd sizes =
        earlier.use.has_new_targets ? reduced.sensor->unknown_sizes() : VectorXd();
    prior.covariance = MatrixXd::Zero(count + sizes.size(), count + sizes.size());
    prior.covariance.topLeftCorner(count, count) = of_estimate;
    prior.covariance.diagonal().tail(sizes.size()) = sizes.cwiseAbs2();
    return prior;
}

/// Widens a factor that a size is known within, as its estimate says, for other poses and days:
/// what the model lacks differs from pose to pose of real robots, so that twenty planned poses know
/// it within 1.2 to 1.5, many within 1.2. At most the factor for any robot.
double elsewhere(double within, double of_any) {
    constexpr double factor = 1.3;
    return std::min(std::exp(std::hypot(std::log(within), std::log(factor))), of_any);
}

/// Whether residuals show a model error that the estimate does not have: without priors none is
/// found, and beyond the largest none is looked for.
bool shows_model_error(const Campaign& campaign, const Estimate& estimate, bool is_angle) {
    const double found = is_angle ? estimate.model_error_orientation : estimate.model_error;
    const double stated = is_angle ? campaign.model_error_orientation : campaign.model_error;
    if (detail::is_model_error_open(campaign) && found < detail::most_model_errors * stated) {
        return false;
    }
    const auto ratio = detail::clear_ratio(estimate.variance_of(is_angle), estimate.loss.kind);
    return ratio && *ratio > 1;
}

double targets_with_lengths(const Campaign& campaign) {
    const Sensor& sensor = *campaign.sensor;
    double count = 0;
    for (Index j = 0; j < sensor.target_count(); ++j) {
        count += sensor.is_angle(sensor.first_row(j)) ? 0 : 1;  // lengths come first
    }
    return count;
}

/// The campaign with the model error that its estimate has found or that its residuals show.
Campaign with_shown_model_error(const Campaign& campaign, const Estimate& estimate) {
    constexpr Index configurations = 64;
    Campaign shown = with_model_error(campaign, estimate);
    shown.known_within.model_error = estimate.model_error_within;
    if (!shows_model_error(campaign, estimate, false) &&
        !shows_model_error(campaign, estimate, true)) {
        return shown;
    }
    const auto predictions = predict_errors(
        shown, estimate,
        detail::random_configurations(campaign.robot, configurations, campaign.seed));
    for (const ErrorPrediction& prediction : predictions) {
        const bool is_angle = prediction.is_angle;
        if (!shows_model_error(campaign, estimate, is_angle)) continue;
        (is_angle ? shown.model_error_orientation : shown.model_error) =
            detail::fitting_model_error(campaign, estimate, prediction.overall, is_angle);
        if (is_angle) continue;
        // Of the logarithm of a variance; the targets of a configuration are off alike.
        const double freedom =
            estimate.variance_of(is_angle).degrees_of_freedom / targets_with_lengths(campaign);
        shown.known_within.model_error = std::exp(1 / std::sqrt(2 * freedom));
    }
    return shown;
}

/// How surely sizes are known that were learned along, in the mean of them: the more, the more of
/// the errors that share one the estimate tells. `learned` has them as its spread.
double sizes_within(const Campaign& learned, const Estimate& estimate) {
    const std::vector<SharedSize> sizes = shared_sizes(learned.spread, learned.robot);
    const VectorXd variances = estimate.covariance.diagonal().segment(
        base_parameter_count(learned), learned.robot.parameter_count());
    double told = 0;
    for (const SharedSize& shared : sizes) {
        for (const Index k : shared.members) {
            told += std::max(0.0, 1 - variances[k] / (shared.size * shared.size));
        }
    }
    const double each = told / static_cast<double>(std::max<std::size_t>(1, sizes.size()));
    return std::exp(std::sqrt(detail::log_size_variance(each)));
}

/// By how much what was found moves where what was known is off: by e, then by the d of least
/// |J_f d + J_k e|^2 + d^T P d, P what was known of it before; d = -(J_f^T J_f + P)^-1 J_f^T J_k e.
MatrixXd follow(const Campaign& campaign, const Parameters& at, const Measurements& measured,
                const std::vector<Index>& of_found, const std::vector<Index>& of_known,
                const MatrixXd& P) {
    const Blocks blocks = make_blocks(campaign, at, measured.configurations, times_seen(measured));
    const VectorXd scale = parameter_scale(campaign);
    const MatrixXd J_f = blocks.matrix(Eigen::all, of_found);
    const MatrixXd J_k = blocks.matrix(Eigen::all, of_known);
    const MatrixXd M = J_f.transpose() * J_f + P;
    const MatrixXd d = -M.llt().solve(J_f.transpose() * J_k);
    return scale(of_found).asDiagonal() * d * scale(of_known).cwiseInverse().asDiagonal();
}

std::string describe(const Isometry3d& base, bool is_turned) {
    const Vector3d p = mm_per_m * base.translation();
    const std::string place = fmt::format("({:.9g}, {:.9g}, {:.9g}) mm", p.x(), p.y(), p.z());
    if (!is_turned) return place;
    const Vector3d rpy = rpy_from_rotation(base.linear());
    return fmt::format("{}, rpy ({:.9g}, {:.9g}, {:.9g}) deg", place, to_degrees(rpy.x()),
                       to_degrees(rpy.y()), to_degrees(rpy.z()));
}

}  // namespace

namespace detail {

void check_known_base(const Campaign& campaign, const Earlier& earlier) {
    if (earlier.use.has_new_base) return;
    constexpr double alike = 1e-6;  // m or rad
    const auto& known = campaign.base_is_known;
    const Isometry3d& stated = campaign.nominal.world_from_base;
    const Isometry3d& found = earlier.estimate.parameters.world_from_base;
    bool is_elsewhere = false;
    for (Index axis = 0; axis < 3; ++axis) {
        const double apart = std::abs(found.translation()[axis] - stated.translation()[axis]);
        is_elsewhere |= known[static_cast<std::size_t>(axis)] && apart > alike;
    }
    const Eigen::AngleAxisd turn(found.linear() * stated.linear().transpose());
    const bool is_turned = known[3] && known[4] && known[5] && std::abs(turn.angle()) > alike;
    if (!is_elsewhere && !is_turned) return;
    throw InputError(fmt::format(
        "the base is at {}, the campaign states one at {} as known; must be stated as when the "
        "estimate was made, unless `earlier.has_new_base` says that it is another",
        describe(found, is_turned), describe(stated, is_turned)));
}

KnownParameters known_parameters(const Campaign& campaign, const std::vector<std::string>& only) {
    const std::vector<std::string> names = campaign.robot.parameter_names();
    const bool knows = !only.empty();
    KnownParameters known{knows, knows, std::vector<bool>(names.size(), knows)};
    for (const std::string& name : only) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (name == "base") {
            known.base = false;
        } else if (name == "targets") {
            known.targets = false;
        } else if (name == "robot") {
            std::fill(known.robot.begin(), known.robot.end(), false);
        } else if (found != names.end()) {
            known.robot[static_cast<std::size_t>(found - names.begin())] = false;
        } else {
            throw InputError(quote(name) +
                             " is no error of this robot; must be one, or base, targets or robot");
        }
    }
    if (numbers_of(mark_known(campaign, known), false).empty()) {
        throw InputError(
            "nothing is left to identify; all that is named is known, by the campaign");
    }
    return known;
}

Campaign with_known(const Campaign& campaign, const KnownParameters& known,
                    const Parameters& values) {
    Campaign changed = campaign;
    if (known.base) {
        changed.base_is_known.fill(true);
        changed.nominal.world_from_base = values.world_from_base;
        changed.has_nominal_base = true;
    }
    if (known.targets) changed = with_known_sensor(std::move(changed), values.sensor);
    changed = with_robot(changed, with_known_errors(campaign.robot, values.robot, known.robot));
    changed.nominal.robot = values.robot(numbers_of(known.robot, false));
    return changed;
}

Parameters complete(const KnownParameters& known, const Parameters& values,
                    const Parameters& found) {
    Parameters whole = found;  // its base is as it was where that is known
    whole.robot = values.robot;
    const std::vector<Index> unknown = numbers_of(known.robot, false);
    for (std::size_t k = 0; k < unknown.size(); ++k) {
        whole.robot[unknown[k]] = found.robot[static_cast<Index>(k)];
    }
    if (known.targets) whole.sensor = values.sensor;
    return whole;
}

Estimate complete(const Campaign& campaign, const Estimate& earlier, const KnownParameters& known,
                  const Campaign& reduced, const Measurements& measured, const Estimate& found) {
    const std::vector<bool> marks = mark_known(campaign, known);
    const std::vector<Index> of_earlier = numbers_of(marks, true);
    if (of_earlier.empty()) return found;
    const std::vector<Index> of_found = numbers_of(marks, false);
    Estimate whole = found;
    whole.names = parameter_names(campaign);
    whole.parameters = complete(known, earlier.parameters, found.parameters);
    const Index size = parameter_count(campaign);
    const MatrixXd C = earlier.covariance(of_earlier, of_earlier);
    const MatrixXd G = follow(with_model_error(campaign, found), whole.parameters, measured,
                              of_found, of_earlier, prior_information(reduced));
    whole.covariance.resize(size, size);
    whole.covariance(of_earlier, of_earlier) = C;
    whole.covariance(of_found, of_found) = found.covariance + G * C * G.transpose();
    whole.covariance(of_found, of_earlier) = G * C;
    whole.covariance(of_earlier, of_found) = (G * C).transpose();
    return whole;
}

}  // namespace detail

Campaign with_earlier(const Campaign& campaign, const Earlier& earlier) {
    const Estimate& estimate = earlier.estimate;
    const EarlierUse& use = earlier.use;
    if (estimate.names != parameter_names(campaign)) {
        throw InputError("the earlier estimate is of other parameters than those of " +
                         campaign.name);
    }
    detail::check_known_base(campaign, earlier);
    const KnownParameters known = detail::known_parameters(campaign, use.only);
    const bool holds_base = known.base && base_parameter_count(campaign) > 0;
    if ((holds_base && use.has_new_base) || (known.targets && use.has_new_targets)) {
        throw InputError("base and targets that were moved must be identified, too");
    }
    Campaign expected = with_shown_model_error(campaign, estimate);
    expected.known_within.model_error =
        elsewhere(expected.known_within.model_error, model_error_factor);
    // Where the prior is drift besides, that is stated as roughly as sizes are.
    if (estimate.spread && !use.is_prior) {
        expected.known_within.error_size =
            elsewhere(sizes_within(expected, estimate), error_size_factor);
    }
    if (!use.has_new_base) {
        expected.nominal.world_from_base = estimate.parameters.world_from_base;
        expected.has_nominal_base = true;
    }
    if (!use.has_new_targets) {
        expected.nominal.sensor = estimate.parameters.sensor;
        expected.has_nominal_targets = true;
    }
    Parameters held = estimate.parameters;
    held.world_from_base = expected.nominal.world_from_base;
    Campaign changed = detail::with_known(expected, known, held);
    if (!use.is_prior) return changed;
    changed.spread.is_prior = true;
    changed.prior = make_prior(campaign, changed, earlier, known);
    return changed;
}

VectorXd errors_under_loads(const Chain& robot, const VectorXd& errors, const Chain& loaded) {
    if (robot.parameter_names() != loaded.parameter_names()) {
        throw InputError("the robots have other errors; must be the same robot");
    }
    VectorXd scaled = errors;
    const std::vector<Compliance> before = compliances(robot);
    const std::vector<Compliance> now = compliances(loaded);
    for (std::size_t i = 0; i < before.size() && i < now.size(); ++i) {
        scaled[now[i].parameter] *= now[i].largest / before[i].largest;
    }
    return scaled;
}

}  // namespace posewise
