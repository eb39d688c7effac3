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

/// Where the parameters of the robot less what is known are among all of them.
std::vector<Index> open_parameters(const Campaign& campaign, const std::vector<bool>& is_known) {
    const Index begin = base_parameter_count(campaign);
    std::vector<Index> open(static_cast<std::size_t>(begin));
    std::iota(open.begin(), open.end(), Index{0});
    for (const Index k : numbers_of(is_known, false)) open.push_back(begin + k);
    for (Index k = begin + std::ssize(is_known); k < parameter_count(campaign); ++k) {
        open.push_back(k);
    }
    return open;
}

/// The covariance of what was known then, a year or so later.
MatrixXd drifted(const Campaign& campaign, const Earlier& earlier) {
    MatrixXd covariance = earlier.estimate.covariance;
    const Index begin = base_parameter_count(campaign);
    for (Index k = 0; k < campaign.robot.parameter_count(); ++k) {
        const Element& element = campaign.robot.parameter_element(k);
        const bool is_offset =
            !element.joints.empty() && campaign.robot.parameter_term(k) == nullptr;
        const double drift = element.motion == Motion::Translation ? earlier.drift.length
                             : is_offset                           ? earlier.drift.offset
                                                                   : earlier.drift.angle;
        covariance(begin + k, begin + k) += drift * drift;
    }
    return covariance;
}

/// Of `reduced`, the campaign less what is known.
Prior make_prior(const Campaign& campaign, const Campaign& reduced, const Earlier& earlier,
                 const std::vector<bool>& is_known) {
    Prior prior{earlier.estimate.parameters, !earlier.has_new_base, !earlier.has_new_targets, {}};
    prior.mean.robot = open_values(prior.mean.robot, is_known);
    std::vector<Index> told = open_parameters(campaign, is_known);
    if (earlier.has_new_targets) {
        told.resize(told.size() - static_cast<std::size_t>(prior.mean.sensor.size()));
    }
    if (earlier.has_new_base)
        told.erase(told.begin(), told.begin() + base_parameter_count(reduced));
    prior.covariance = drifted(campaign, earlier)(told, told);
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
    if (!earlier.is_prior) return changed;
    changed.spread.is_prior = true;
    changed.prior = make_prior(campaign, changed, earlier, is_known);
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
    const std::vector<Index> of_found = open_parameters(campaign, is_known);
    std::vector<Index> of_earlier;
    for (const Index k : known) of_earlier.push_back(begin + k);
    whole.covariance = MatrixXd::Zero(size, size);
    whole.covariance(of_found, of_found) = found.covariance;
    whole.covariance(of_earlier, of_earlier) = earlier.covariance(of_earlier, of_earlier);
    return whole;
}

}  // namespace posewise::detail
