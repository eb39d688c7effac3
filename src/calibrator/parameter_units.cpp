#include "parameter_units.hpp"

#include "core/products.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {

ParameterUnits::ParameterUnits(const Campaign& campaign)
    : scale_(parameter_scale(campaign)), begin_(prior_begin(campaign)) {
    if (!campaign.prior) return;
    const Index count = prior_count(campaign);
    const MatrixXd root = cholesky(campaign.prior->covariance);
    if (root.rows() != count) {
        throw InputError(
            "the prior is of other parameters, or its covariance not positive definite");
    }
    units_ = scale_.asDiagonal();
    units_.block(begin_, begin_, count, count) = root;
}

VectorXd ParameterUnits::prior_coordinates(const Campaign& campaign,
                                           const Parameters& parameters) const {
    const Index count = prior_count(campaign);
    if (units_.size() == 0) {
        const Index of_robot = campaign.spread.is_prior ? parameters.robot.size() : 0;
        VectorXd errors(count);
        errors << parameters.robot.head(of_robot), parameters.sensor.head(count - of_robot);
        return errors.cwiseQuotient(scale_.segment(begin_, count));
    }
    return units_.block(begin_, begin_, count, count)
        .triangularView<Eigen::Lower>()
        .solve(step_between(campaign, campaign.prior->mean, parameters).segment(begin_, count));
}

MatrixXd ParameterUnits::prior_derivative(const Campaign& campaign,
                                          const Parameters& parameters) const {
    const Index count = prior_count(campaign);
    if (units_.size() == 0 || !campaign.prior->has_base) return MatrixXd::Identity(count, count);
    const auto L = units_.block(begin_, begin_, count, count).triangularView<Eigen::Lower>();
    const MatrixXd D = differentiate_step(campaign, campaign.prior->mean, parameters);
    return L.solve(D.block(begin_, begin_, count, count) * MatrixXd(L));
}

VectorXd ParameterUnits::step(const VectorXd& d) const {
    if (units_.size() == 0) return scale_.cwiseProduct(d);
    return units_ * d;
}

void ParameterUnits::scale_columns(Eigen::Ref<RowMatrixXd> J) const {
    if (units_.size() == 0) {
        J *= scale_.asDiagonal();
    } else {
        J *= units_;
    }
}

void ParameterUnits::unscale(MatrixXd& covariance) const {
    if (units_.size() == 0) {
        covariance.array() *= (scale_ * scale_.transpose()).array();
    } else {
        covariance = units_ * covariance * units_.transpose();
    }
}

}  // namespace posewise::detail
