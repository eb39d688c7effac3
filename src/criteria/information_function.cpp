#include "information_function.hpp"

#include <cmath>

#include "core/elementary.hpp"
#include "prediction.hpp"
#include "regular.hpp"

namespace posewise::detail {
namespace {

/// Whether phi is its square.
bool is_root(Criterion criterion) {
    return criterion == Criterion::O1 || criterion == Criterion::O3 || criterion == Criterion::O5;
}

/// phi = factor value^2 where it is a root.
double factor_of(const Objective& objective) {
    return objective.criterion == Criterion::O1 ? static_cast<double>(objective.pose_count) : 1;
}

/// d phi / d value.
double information_slope(const Objective& objective, double value, Index parameter_count) {
    const double phi = information_of_value(objective, value, parameter_count);
    if (is_logarithm(objective.criterion)) {
        return phi / static_cast<double>(interest_count(objective, parameter_count));
    }
    return is_root(objective.criterion) ? 2 * phi / value : 1;
}

/// The worst of the test poses is not below their mean by any weights, whose information function
/// is the weighted A.
MatrixXd supporting_matrix_of_worst_prediction(const Objective& objective, const MatrixXd& M) {
    const Eigen::LLT<MatrixXd> cholesky(M);
    const VectorXd slope = worst_variance(objective, cholesky).slope;
    const RowMatrixXd weighted = weighted_rows(*objective.test_poses, slope / slope.sum());
    const RowMatrixXd by_rows = weighted * inverse(cholesky);
    const double trace = by_rows.cwiseProduct(weighted).sum();
    return symmetric_gram(by_rows) / (trace * trace);  // which keeps more digits than W C W
}

}  // namespace

Index interest_count(const Objective& objective, Index parameter_count) {
    return parameter_count - static_cast<Index>(objective.nuisance.size());
}

bool has_information_function(Criterion criterion) {
    return criterion != Criterion::O2 && criterion != Criterion::O4;
}

double information_of_value(const Objective& objective, double value, Index parameter_count) {
    if (is_logarithm(objective.criterion)) {
        return exponential(value / static_cast<double>(interest_count(objective, parameter_count)));
    }
    return is_root(objective.criterion) ? factor_of(objective) * value * value : value;
}

double value_of_information(const Objective& objective, double phi, Index parameter_count) {
    if (is_logarithm(objective.criterion)) {
        return static_cast<double>(interest_count(objective, parameter_count)) * logarithm(phi);
    }
    return is_root(objective.criterion) ? std::sqrt(phi / factor_of(objective)) : phi;
}

MatrixXd supporting_matrix(const Objective& objective, const MatrixXd& M) {
    if (!objective.nuisance.empty()) {
        Objective reduced_objective = objective;
        reduced_objective.nuisance.clear();
        const Reduction reduced = eliminate(M, objective.nuisance);
        return reduced.N * supporting_matrix(reduced_objective, reduced.M) * reduced.N.transpose();
    }
    if (objective.criterion == Criterion::G) {
        return supporting_matrix_of_worst_prediction(objective, M);
    }
    const MatrixXd Z = gradient(objective, M);
    // The least eigenvalue of M* is below trace(Z M*) for any Z >= 0 of trace 1.
    if (objective.criterion == Criterion::E || objective.criterion == Criterion::O3) {
        return Z / Z.trace();
    }
    return information_slope(objective, evaluate(objective, M), M.rows()) * Z;
}

}  // namespace posewise::detail
