#include "covariance_adaptation.hpp"

#include <algorithm>
#include <cmath>

#include "core/decompositions.hpp"
#include "global_identification.hpp"

namespace posewise::detail {
namespace {

/// What does not let base and targets be registered fits worse than anything, m.
constexpr double worse_than_any = 1e6;

/// The misfit over the errors that are searched, each from -1 to 1 of its bound.
class Misfit {
  public:
    Misfit(const Campaign& campaign, const Measurements& means, const VectorXd& bounds)
        : campaign_(campaign), means_(means), bounds_(bounds) {
        for (Index k = 0; k < bounds.size(); ++k) {
            if (bounds[k] > 0) searched_.push_back(k);
        }
    }

    Index size() const { return static_cast<Index>(searched_.size()); }

    VectorXd errors(const VectorXd& x) const {
        VectorXd errors = VectorXd::Zero(bounds_.size());
        errors(searched_) = x.cwiseProduct(bounds_(searched_));
        return errors;
    }

    /// Distance RMS, m.
    double operator()(const VectorXd& x) const {
        const Registration found =
            detail::register_roughly_with_errors(campaign_, means_, errors(x));
        if (!found.is_determined()) return worse_than_any;
        return make_metrics(campaign_, found.parameters, means_).rms();
    }

  private:
    const Campaign& campaign_;
    const Measurements& means_;
    const VectorXd& bounds_;
    std::vector<Index> searched_;
};

/// Covariance matrix adaptation with the constants of Hansen's tutorial (arXiv 1604.00772); what
/// leaves the box is judged at its border and costs more the farther it is outside.
class CovarianceAdaptation {
  public:
    CovarianceAdaptation(const Misfit& misfit, const RandomStream& stream)
        : misfit_(misfit),
          stream_(stream),
          n_(static_cast<double>(misfit.size())),
          population_(4 + static_cast<Index>(3 * std::log(n_))),
          parents_(population_ / 2),
          weights_(parents_),
          best_(VectorXd::Zero(misfit.size())),
          mean_(best_),
          path_(best_),
          step_path_(best_),
          C_(MatrixXd::Identity(best_.size(), best_.size())) {
        for (Index i = 0; i < parents_; ++i) {
            weights_[i] = std::log(0.5 * static_cast<double>(population_ + 1)) -
                          std::log(static_cast<double>(i + 1));
        }
        weights_ /= weights_.sum();
        mass_ = 1 / weights_.squaredNorm();
    }

    VectorXd run(Index evaluation_limit) {
        constexpr double least_step = 1e-6;
        for (Index count = 0; count < evaluation_limit; count += population_) {
            if (advance() < least_step) break;
        }
        return best_;
    }

  private:
    struct Member {
        VectorXd step;  ///< from the mean, in units of sigma
        double value;
    };

    double judge(const VectorXd& x) {
        const VectorXd inside = x.cwiseMax(-1).cwiseMin(1);
        const double value = misfit_(inside);
        if (value < best_value_) {
            best_value_ = value;
            best_ = inside;
        }
        return value * (1 + (x - inside).squaredNorm());
    }

    /// One generation; the largest standard deviation it was drawn with.
    double advance() {
        const auto eigen = eigen_decomposition(C_);
        const VectorXd D = eigen.eigenvalues().cwiseMax(1e-20).cwiseSqrt();
        const MatrixXd& B = eigen.eigenvectors();
        std::vector<Member> members;
        for (Index i = 0; i < population_; ++i) {
            VectorXd z(mean_.size());
            for (double& value : z) value = stream_.normal();
            const VectorXd step = B * D.cwiseProduct(z);
            members.push_back({step, judge(mean_ + sigma_ * step)});
        }
        std::stable_sort(members.begin(), members.end(),
                         [](const Member& a, const Member& b) { return a.value < b.value; });
        adapt(members, B * D.cwiseInverse().asDiagonal() * B.transpose());
        return sigma_ * D.maxCoeff();
    }

    void adapt(const std::vector<Member>& members, const MatrixXd& inverse_root) {
        const double step_rate = (mass_ + 2) / (n_ + mass_ + 5);
        const double damping =
            1 + 2 * std::max(0.0, std::sqrt((mass_ - 1) / (n_ + 1)) - 1) + step_rate;
        const double path_rate = (4 + mass_ / n_) / (n_ + 4 + 2 * mass_ / n_);
        const double rank_one = 2 / ((n_ + 1.3) * (n_ + 1.3) + mass_);
        const double rank_mu =
            std::min(1 - rank_one, 2 * (mass_ - 2 + 1 / mass_) / ((n_ + 2) * (n_ + 2) + mass_));
        const double normal_length = std::sqrt(n_) * (1 - 1 / (4 * n_) + 1 / (21 * n_ * n_));

        VectorXd step = VectorXd::Zero(mean_.size());
        MatrixXd spread = MatrixXd::Zero(C_.rows(), C_.cols());
        for (Index i = 0; i < parents_; ++i) {
            const VectorXd& of_member = members[static_cast<std::size_t>(i)].step;
            step += weights_[i] * of_member;
            spread += weights_[i] * of_member * of_member.transpose();
        }
        mean_ += sigma_ * step;
        step_path_ = (1 - step_rate) * step_path_ +
                     std::sqrt(step_rate * (2 - step_rate) * mass_) * (inverse_root * step);
        const double generations = static_cast<double>(++generation_);
        const double expected =
            std::sqrt(1 - std::pow(1 - step_rate, 2 * generations)) * normal_length;
        const bool is_moderate = step_path_.norm() < (1.4 + 2 / (n_ + 1)) * expected;
        path_ = (1 - path_rate) * path_;
        if (is_moderate) path_ += std::sqrt(path_rate * (2 - path_rate) * mass_) * step;
        const double lost = is_moderate ? 0 : rank_one * path_rate * (2 - path_rate);
        C_ = (1 - rank_one - rank_mu + lost) * C_ + rank_one * path_ * path_.transpose() +
             rank_mu * spread;
        sigma_ *= std::exp(step_rate / damping * (step_path_.norm() / normal_length - 1));
        sigma_ = std::min(sigma_, 1.0);
    }

    const Misfit& misfit_;
    RandomStream stream_;
    double n_;
    Index population_;
    Index parents_;
    VectorXd weights_;
    double mass_ = 1;  ///< variance effective number of parents
    VectorXd best_;
    double best_value_ = worse_than_any;
    VectorXd mean_;
    VectorXd path_;
    VectorXd step_path_;
    MatrixXd C_;
    double sigma_ = 0.5;
    Index generation_ = 0;
};

}  // namespace

VectorXd adapt_covariance(const Campaign& campaign, const Measurements& means,
                          const VectorXd& bounds, Index evaluation_limit,
                          const RandomStream& stream) {
    const Misfit misfit(campaign, means, bounds);
    if (misfit.size() == 0) return VectorXd::Zero(bounds.size());
    return misfit.errors(CovarianceAdaptation(misfit, stream).run(evaluation_limit));
}

}  // namespace posewise::detail
