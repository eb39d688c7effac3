#include "left_out.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "measurement/noise.hpp"

namespace posewise::detail {
namespace {

/// Where parameters with these names stand among all,
/// then the places that no name has.
struct Split {
    std::vector<Index> fitted;
    std::vector<Index> left_out;
};

std::optional<Split> split(const std::vector<std::string>& all,
                           const std::vector<std::string>& fitted) {
    Split found;
    for (const std::string& name : fitted) {
        const auto place = std::ranges::find(all, name);
        if (place == all.end()) return std::nullopt;
        found.fitted.push_back(place - all.begin());
    }
    for (Index k = 0; k < std::ssize(all); ++k) {
        if (std::ranges::count(found.fitted, k) == 0) found.left_out.push_back(k);
    }
    return found;
}

/// The richer campaign with weights as the poorer one has them.
Campaign weighed_as(const Campaign& poorer, Campaign richer) {
    richer.model_error = poorer.model_error;
    richer.model_error_orientation = poorer.model_error_orientation;
    richer.model_error_common = common_part(poorer);
    return richer;
}

/// RMS position error by errors left out, m; `richer` weighs as `poorer` does.
double bias(const Planning& poorer, const Planning& richer, const Split& parameters) {
    const MatrixXd& C = richer.errors.by_parameters.matrix;
    const MatrixXd shown = richer.information(parameters.fitted, parameters.left_out);
    // Each campaign scales parameters by the sizes that it expects.
    const VectorXd scale = parameter_scale(richer.campaign)(parameters.fitted)
                               .cwiseQuotient(parameter_scale(poorer.campaign));
    const MatrixXd M = scale.asDiagonal() * poorer.information * scale.asDiagonal();
    const MatrixXd taken = M.llt().solve(shown);
    const MatrixXd off =
        C(Eigen::all, parameters.left_out) - C(Eigen::all, parameters.fitted) * taken;
    return std::sqrt(3 * off.squaredNorm() / static_cast<double>(C.rows()));
}

}  // namespace

void judge_left_out(Planning& planning, const PlanningOptions& options) {
    const Plan& plan = planning.plan;
    if (!options.richer || !plan.request.sources.estimate.empty() || !plan.predicted) return;
    const std::vector<OtherCampaign> campaigns = options.richer();
    if (campaigns.empty()) return;
    const auto& [key, richest] = campaigns.back();
    const auto parameters = split(parameter_names(richest), parameter_names(planning.campaign));
    if (!parameters || parameters->left_out.empty()) return;
    const Planning weighed = judge_again(plan, weighed_as(planning.campaign, richest), options);
    const double promised = predict_total(*plan.predicted).rms;
    planning.left_out = {key, std::ssize(parameters->left_out), promised,
                         std::hypot(promised, bias(planning, weighed, *parameters)),
                         predict_total(*judge_again(plan, richest, options).plan.predicted).rms};
}

}  // namespace posewise::detail
