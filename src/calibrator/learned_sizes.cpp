#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

constexpr int iteration_limit = 100;
constexpr double tolerance = 0.005;  // of a size, to end at

/// The errors that share a size.
struct Sharing {
    double stated = 0;
    double squares = 0;  ///< summed up
    Index count = 0;
};

/// The most probable size: the root of n - S / s^2 + log(s / stated) / log(factor)^2, which grows
/// with s.
double most_probable(const Sharing& errors) {
    const double log_factor = std::log(error_size_factor);
    const double middle = std::log(errors.stated);
    double low = middle - 20;
    double high = middle + 20;
    for (int i = 0; i < 60; ++i) {
        const double u = 0.5 * (low + high);
        const double slope = static_cast<double>(errors.count) - errors.squares * std::exp(-2 * u) +
                             (u - middle) / (log_factor * log_factor);
        (slope > 0 ? high : low) = u;
    }
    return std::exp(high);
}

/// The next sizes; by how large a part any of them changed.
double update(ParameterSpread& spread, ParameterSpread stated, const Chain& robot,
              const VectorXd& squares) {
    std::map<double*, Sharing> sizes;
    const auto names = robot.parameter_names();
    for (Index k = 0; k < squares.size(); ++k) {
        if (stated.by_name.count(names[static_cast<std::size_t>(k)]) > 0) continue;
        Sharing& errors = sizes[&size_of(spread, robot, k)];
        errors.stated = size_of(stated, robot, k);
        errors.squares += squares[k];
        ++errors.count;
    }
    double change = 0;
    for (const auto& [size, errors] : sizes) {
        const double next = most_probable(errors);
        change = std::max(change, std::abs(next / *size - 1));
        *size = next;
    }
    return change;
}

constexpr double looser = 100;        // than stated: holds nothing back
constexpr double doubtful = 3;        // times the size learned
constexpr double clear_evidence = 5;  // as a logarithm: 150 to 1

double root_mean_square(const VectorXd& values) {
    return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

/// Of the measurements under the campaign's sizes and model error, but for a constant, by the
/// estimate under them (Laplace: as if it were linear).
double log_evidence(const Campaign& campaign, const Estimate& estimate) {
    const Eigen::LLT<MatrixXd> covariance(estimate.covariance);
    if (estimate.ending == Ending::NotIdentifiable || covariance.info() != Eigen::Success) {
        return -std::numeric_limits<double>::infinity();
    }
    const VectorXd sizes = parameter_scale(campaign).segment(base_parameter_count(campaign),
                                                             campaign.robot.parameter_count());
    return -0.5 * estimate.variance_factor * static_cast<double>(estimate.degrees_of_freedom) +
           covariance.matrixLLT().diagonal().array().log().sum() - sizes.array().log().sum();
}

}  // namespace

ParameterSpread learn_sizes(const Campaign& campaign, const Measurements& measurements,
                            const Parameters& start, const LevenbergMarquardtOptions& options) {
    if (!campaign.spread.is_prior) {
        throw InputError(
            "sizes of errors can be learned only where expected sizes are priors "
            "(`spread.is_prior`)");
    }
    Campaign learned = campaign;
    Parameters from = start;
    for (int i = 0; i < iteration_limit && !options.stop.is_set(); ++i) {
        const Estimate estimate = identify(learned, measurements, from, options);
        if (estimate.ending == Ending::NotIdentifiable) break;
        from = estimate.parameters;
        const VectorXd& errors = from.robot;
        const VectorXd variances =
            estimate.covariance.diagonal().segment(base_parameter_count(campaign), errors.size());
        const VectorXd squares = errors.cwiseAbs2() + variances;
        if (update(learned.spread, campaign.spread, campaign.robot, squares) < tolerance) break;
    }
    return learned.spread;
}

std::optional<HeldBackSize> find_held_back_size(const Campaign& learned,
                                                const ParameterSpread& stated,
                                                const Measurements& measurements,
                                                const Parameters& start,
                                                const LevenbergMarquardtOptions& options) {
    if (options.loss.kind != LossKind::Squares) return std::nullopt;
    LevenbergMarquardtOptions fixed = options;
    fixed.finds_model_error = false;
    const auto evidence_of = [&](const Campaign& campaign) {
        return log_evidence(campaign, identify(campaign, measurements, start, fixed));
    };
    std::optional<HeldBackSize> found;
    Campaign best = learned;
    double largest = -std::numeric_limits<double>::infinity();
    for (const SharedSize& shared : shared_sizes(learned.spread, learned.robot)) {
        Campaign other = learned;
        other.spread = stated;
        double& size = size_of(other.spread, other.robot, shared.members.front());
        size *= looser;
        const Estimate loose = identify(other, measurements, start, fixed);
        if (loose.ending == Ending::NotIdentifiable) continue;
        size = root_mean_square(loose.parameters.robot(shared.members));
        if (size < doubtful * shared.size) continue;
        const double evidence = evidence_of(other);
        if (evidence <= largest) continue;
        largest = evidence;
        best = other;
        found = HeldBackSize{shared};
    }
    if (!found || options.stop.is_set()) return std::nullopt;
    best.spread = learn_sizes(best, measurements, start, options);
    if (evidence_of(best) - evidence_of(learned) < clear_evidence) return std::nullopt;
    found->fitting = size_of(best.spread, best.robot, found->held.members.front());
    return found;
}

}  // namespace posewise
