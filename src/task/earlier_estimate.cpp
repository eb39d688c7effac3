#include "earlier_estimate.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "../core/text.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

std::vector<Index> numbers_of(const std::vector<bool>& is_known, bool wanted) {
    std::vector<Index> numbers;
    for (std::size_t k = 0; k < is_known.size(); ++k) {
        if (is_known[k] == wanted) numbers.push_back(static_cast<Index>(k));
    }
    return numbers;
}

/// Of the robot's errors, a year or so later: those of before, and what has drifted since.
RobotPrior drifted(const Campaign& campaign, const Earlier& earlier) {
    const Index begin = base_parameter_count(campaign);
    const Index count = campaign.robot.parameter_count();
    RobotPrior prior{earlier.estimate.parameters.robot,
                     earlier.estimate.covariance.block(begin, begin, count, count)};
    for (Index k = 0; k < count; ++k) {
        const bool is_angle = campaign.robot.parameter_element(k).motion == Motion::Rotation;
        const double drift = is_angle ? earlier.drift.angle : earlier.drift.length;
        prior.covariance(k, k) += drift * drift;
    }
    return prior;
}

}  // namespace

std::vector<bool> known_errors(const Campaign& campaign, const std::vector<std::string>& only) {
    const std::vector<std::string> names = campaign.robot.parameter_names();
    std::vector<bool> is_known(names.size(), !only.empty());
    bool has_base = only.empty();
    bool has_targets = only.empty();
    for (const std::string& name : only) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (name == "base") {
            has_base = true;
        } else if (name == "targets") {
            has_targets = true;
        } else if (name == "robot") {
            std::fill(is_known.begin(), is_known.end(), false);
        } else if (found != names.end()) {
            is_known[static_cast<std::size_t>(found - names.begin())] = false;
        } else {
            throw InputError(quote(name) +
                             " is no error of this robot; must be one, or base, targets or robot");
        }
    }
    if (!has_base || !has_targets) {
        throw InputError(
            "base and targets are always identified; both must be named, then errors of the robot");
    }
    return is_known;
}

Campaign with_earlier(const Campaign& campaign, const Earlier& earlier,
                      const std::vector<bool>& is_known) {
    const Chain robot =
        with_known_errors(campaign.robot, earlier.estimate.parameters.robot, is_known);
    Campaign changed = with_robot(campaign, robot);
    changed.model_error = earlier.estimate.model_error;
    changed.model_error_orientation = earlier.estimate.model_error_orientation;
    if (!earlier.is_prior || robot.parameter_count() == 0) return changed;
    const std::vector<Index> open = numbers_of(is_known, false);
    const RobotPrior all = drifted(campaign, earlier);
    changed.spread.is_prior = true;
    changed.prior = RobotPrior{all.mean(open), all.covariance(open, open)};
    return changed;
}

VectorXd open_values(const VectorXd& values, const std::vector<bool>& is_known) {
    return values(numbers_of(is_known, false));
}

Estimate complete(const Campaign& campaign, const Estimate& earlier,
                  const std::vector<bool>& is_known, const Estimate& found) {
    const std::vector<Index> known = numbers_of(is_known, true);
    if (known.empty()) return found;
    const std::vector<Index> open = numbers_of(is_known, false);
    Estimate whole = found;
    whole.names = parameter_names(campaign);
    whole.parameters.robot = earlier.parameters.robot;
    whole.parameters.robot(open) = found.parameters.robot;
    const Index begin = base_parameter_count(campaign);
    const Index size = parameter_count(campaign);
    std::vector<Index> of_found(static_cast<std::size_t>(begin));  // where its parameters are
    std::iota(of_found.begin(), of_found.end(), Index{0});
    for (const Index k : open) of_found.push_back(begin + k);
    for (Index k = begin + std::ssize(is_known); k < size; ++k) of_found.push_back(k);
    std::vector<Index> of_earlier;
    for (const Index k : known) of_earlier.push_back(begin + k);
    whole.covariance = MatrixXd::Zero(size, size);
    whole.covariance(of_found, of_found) = found.covariance;
    whole.covariance(of_earlier, of_earlier) = earlier.covariance(of_earlier, of_earlier);
    return whole;
}

}  // namespace posewise::detail
