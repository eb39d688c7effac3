#include "learned_sizes.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "normal_equations.hpp"

namespace posewise::detail {
namespace {

constexpr int iteration_limit = 100;
constexpr double size_tolerance = 0.005;  // a relative step of a size to end at

const double log_size_factor = std::log(error_size_factor);

/// The most probable of a size whose `count` errors have these squares, summed up: the root of
/// n - S / s^2 + log(s / expected) / log(factor)^2, which grows with s.
double most_probable(double expected, double squares, Index count) {
    const double middle = std::log(expected);
    double low = middle - 20;
    double high = middle + 20;
    for (int i = 0; i < 60; ++i) {
        const double u = 0.5 * (low + high);
        const double slope = static_cast<double>(count) - squares * std::exp(-2 * u) +
                             (u - middle) / (log_size_factor * log_size_factor);
        (slope > 0 ? high : low) = u;
    }
    return std::exp(high);
}

/// What the measurements say of sizes, in the system linearised at some parameters. Its errors are
/// in units of the sizes that the problem has.
class SizeEvidence {
  public:
    SizeEvidence(const IdentificationProblem& problem, const Parameters& parameters,
                 const ParameterSpread& expected)
        : robot_(problem.campaign.robot), expected_(expected) {
        const NormalEquations equations = normal_equations(problem, linearise(problem, parameters));
        const Index begin = problem.prior_begin();
        const Index count = problem.prior_count();
        const VectorXd theta = problem.units.prior_coordinates(problem.campaign, parameters);
        MatrixXd A = equations.M.selfadjointView<Eigen::Lower>();
        A.diagonal().segment(begin, count).array() -= 1;
        VectorXd b = equations.g + A.middleCols(begin, count) * theta;
        b.segment(begin, count) += theta;
        std::vector<Index> others;
        for (Index k = 0; k < A.rows(); ++k) {
            if (k < begin || k >= begin + count) others.push_back(k);
        }
        const MatrixXd A_oo = A(others, others);
        const MatrixXd A_op = A(others, Eigen::seqN(begin, count));
        const VectorXd b_o = b(others);
        const Eigen::LLT<MatrixXd> cholesky(A_oo);
        S_ = A.block(begin, begin, count, count) - A_op.transpose() * cholesky.solve(A_op);
        b_ = b.segment(begin, count) - A_op.transpose() * cholesky.solve(b_o);
        units_ = robot_error_sizes(problem.campaign.spread, robot_);
    }

    /// Log of the density of the measurements and of the sizes, but for a constant.
    double log_density(const ParameterSpread& spread) const {
        const VectorXd precisions = precisions_of(spread);
        const Eigen::LLT<MatrixXd> root = information(precisions);
        double sum = 0.5 * precisions.array().log().sum() -
                     root.matrixLLT().diagonal().array().log().sum() + 0.5 * b_.dot(root.solve(b_));
        const std::vector<SharedSize> sizes = shared_sizes(spread, robot_);
        const std::vector<SharedSize> expected = shared_sizes(expected_, robot_);
        for (std::size_t k = 0; k < sizes.size(); ++k) {
            const double u = std::log(sizes[k].size / expected[k].size) / log_size_factor;
            sum -= u * u / 2;
        }
        return sum;
    }

    /// The sizes of largest density, uphill from these: by expectation maximisation [Dempster,
    /// Laird & Rubin 1977] over each error's square, estimate^2 + variance.
    ParameterSpread climb(ParameterSpread spread) const {
        for (int i = 0; i < iteration_limit; ++i) {
            const MatrixXd C = covariance(precisions_of(spread));
            const VectorXd in_units = (C * b_).cwiseAbs2() + C.diagonal();
            const VectorXd squares = units_.cwiseAbs2().cwiseProduct(in_units.head(units_.size()));
            if (update(spread, squares) < size_tolerance) break;
        }
        return spread;
    }

    /// What the sizes are on average where these are the most probable: the root of the mean of
    /// their squares, with log-normal densities as wide as the number of errors that the
    /// measurements tell of each class leaves them. With few poses larger ones remain possible.
    ParameterSpread average(ParameterSpread spread) const {
        const VectorXd precisions = precisions_of(spread);
        // The part of each prior variance that the measurements leave.
        const VectorXd left = precisions.cwiseProduct(covariance(precisions).diagonal());
        for (const SharedSize& shared : shared_sizes(expected_, robot_)) {
            const double told = (1 - left(shared.members).array()).sum();
            size_of(spread, robot_, shared.members.front()) *= std::exp(log_size_variance(told));
        }
        return spread;
    }

  private:
    /// Of the prior, in units.
    VectorXd precisions_of(const ParameterSpread& spread) const {
        VectorXd precisions = VectorXd::Ones(S_.rows());  // those of a sensor are not learned
        precisions.head(units_.size()) =
            units_.cwiseQuotient(robot_error_sizes(spread, robot_)).cwiseAbs2();
        return precisions;
    }
    Eigen::LLT<MatrixXd> information(const VectorXd& precisions) const {
        MatrixXd M = S_;
        M.diagonal() += precisions;
        return M.llt();
    }
    MatrixXd covariance(const VectorXd& precisions) const {
        return information(precisions).solve(MatrixXd::Identity(S_.rows(), S_.cols()));
    }

    /// The next sizes; by how large a part any of them changed.
    double update(ParameterSpread& spread, const VectorXd& squares) const {
        double change = 0;
        for (const SharedSize& shared : shared_sizes(expected_, robot_)) {
            double& size = size_of(spread, robot_, shared.members.front());
            const double next = most_probable(shared.size, squares(shared.members).sum(),
                                              std::ssize(shared.members));
            change = std::max(change, std::abs(next / size - 1));
            size = next;
        }
        return change;
    }

    const Chain& robot_;
    const ParameterSpread& expected_;
    MatrixXd S_;  ///< information of the measurements on the errors, whatever base and targets are
    VectorXd b_;  ///< S times the errors that fit best
    VectorXd units_;  ///< one for each error of the robot
};

}  // namespace

double log_size_variance(double told) {
    return 1 / (2 * told + 1 / (log_size_factor * log_size_factor));
}

bool are_sizes_open(const Campaign& campaign, const Loss& loss) {
    return campaign.spread.is_prior && campaign.spread.is_open && !campaign.prior &&
           loss.kind == LossKind::Squares && !shared_sizes(campaign.spread, campaign.robot).empty();
}

ParameterSpread learn_sizes(const IdentificationProblem& problem, const Parameters& parameters,
                            const ParameterSpread& expected) {
    const SizeEvidence evidence(problem, parameters, expected);
    ParameterSpread best = evidence.climb(problem.campaign.spread);
    double highest = evidence.log_density(best);
    // A size far too small holds its errors back, others absorb them: a maximum of its own.
    for (const SharedSize& shared : shared_sizes(best, problem.campaign.robot)) {
        for (const double times : {10.0, 100.0}) {
            ParameterSpread other = best;
            size_of(other, problem.campaign.robot, shared.members.front()) *= times;
            if (!(evidence.log_density(other) > highest)) continue;
            other = evidence.climb(other);
            const double density = evidence.log_density(other);
            if (!(density > highest)) continue;
            best = other;
            highest = density;
        }
    }
    return evidence.average(best);
}

}  // namespace posewise::detail
