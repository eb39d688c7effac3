#include <algorithm>
#include <cmath>
#include <map>

#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

constexpr int iteration_limit = 50;
constexpr double tolerance = 0.01;  // of a size, to end at

/// Mean squares of the errors that share a size.
struct SquareMean {
    double sum;
    Index count = 1;
};

/// The next sizes; by how large a part any of them changed.
double update(ParameterSpread& spread, const ParameterSpread& stated, const Chain& robot,
              const VectorXd& squares) {
    ParameterSpread expected = stated;
    std::map<double*, SquareMean> means;
    const auto names = robot.parameter_names();
    for (Index k = 0; k < squares.size(); ++k) {
        if (stated.by_name.count(names[static_cast<std::size_t>(k)]) > 0) continue;
        const double size = size_of(expected, robot, k);
        SquareMean& mean =
            means.try_emplace(&size_of(spread, robot, k), SquareMean{size * size}).first->second;
        mean.sum += squares[k];
        ++mean.count;
    }
    double change = 0;
    for (const auto& [size, mean] : means) {
        const double next = std::sqrt(mean.sum / static_cast<double>(mean.count));
        change = std::max(change, std::abs(next / *size - 1));
        *size = next;
    }
    return change;
}

}  // namespace

ParameterSpread learn_sizes(const Campaign& campaign, const Measurements& measurements,
                            const Parameters& start, const LevenbergMarquardtOptions& options) {
    if (!campaign.spread.is_prior) {
        throw InputError("sizes of errors can be learned only where expected sizes are priors");
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

}  // namespace posewise
