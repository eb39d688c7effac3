#pragma once

#include <omp.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "posewise/core/random.hpp"
#include "posewise/core/types.hpp"

/// The textbook exchanges of single rows for D, each candidate at most once: references for
/// select_poses. With W = M^-1, d_ij = x_i^T W x_j and d_i = d_ii, exchanging the chosen i for j
/// multiplies det M by (1 + d_j)(1 - d_i) + d_ij^2 [Fedorov 1972].
namespace posewise::reference {

constexpr double least_gain = 1 + 1e-9;  // of det M, for an exchange to count
constexpr int refresh_period = 32;       // exchanges after which rounding is cleared away

/// A choice being exchanged: W and the variances d of all candidates, kept by rank-one updates.
class Design {
  public:
    /// `X` is candidates x parameters and must outlive the design.
    explicit Design(const MatrixXd& X) : X_(X) {}

    const MatrixXd& rows() const { return X_; }
    const std::vector<Index>& poses() const { return poses_; }
    Index pose(Index at) const { return poses_[static_cast<std::size_t>(at)]; }
    Index size() const { return static_cast<Index>(poses_.size()); }
    const MatrixXd& W() const { return W_; }
    const VectorXd& d() const { return d_; }
    const VectorXd& open() const { return open_; }  ///< 0 for chosen candidates, 1 for others
    double log_det() const { return log_det_; }

    /// Of M + ridge I. False if that is singular.
    bool start(std::vector<Index> poses, double ridge = 0) {
        poses_ = std::move(poses);
        open_.setOnes(X_.rows());
        for (const Index pose : poses_) open_[pose] = 0;
        ridge_ = ridge;
        return refresh();
    }

    void append(Index in) {
        poses_.push_back(in);
        open_[in] = 0;
        update(in, 1);
    }

    /// C, if given, holds d_ij of every candidate (rows) and chosen one (columns).
    void exchange(Index at, Index in, MatrixXd* C = nullptr) {
        const Index out = pose(at);
        for (const auto& [candidate, sign] : {std::pair{in, 1.0}, std::pair{out, -1.0}}) {
            const double scale = update(candidate, sign);
            if (C == nullptr) continue;
            for (Index k = 0; k < size(); ++k) C->col(k) -= scale * change_[pose(k)] * change_;
        }
        open_[out] = 1;
        open_[in] = 0;
        poses_[static_cast<std::size_t>(at)] = in;
        const bool is_refreshed = ++exchanges_ % refresh_period == 0 && refresh();
        if (C == nullptr) return;
        if (is_refreshed) *C = covariances();
        if (!is_refreshed) C->col(at).noalias() = X_ * (W_ * X_.row(in).transpose());
    }

    MatrixXd covariances() const {
        MatrixXd chosen(X_.cols(), size());
        for (Index k = 0; k < size(); ++k) chosen.col(k) = X_.row(pose(k)).transpose();
        return X_ * (W_ * chosen);
    }

    /// W, d and log det from the rows themselves.
    bool refresh() {
        const Index L = X_.cols();
        MatrixXd M = ridge_ * MatrixXd::Identity(L, L);
        for (const Index pose : poses_) M += X_.row(pose).transpose() * X_.row(pose);
        const Eigen::LLT<MatrixXd> cholesky(M);
        const VectorXd pivots = cholesky.matrixLLT().diagonal();
        log_det_ = -std::numeric_limits<double>::infinity();
        if (cholesky.info() != Eigen::Success || pivots.minCoeff() < 1e-5 * pivots.maxCoeff()) {
            return false;
        }
        log_det_ = 2 * pivots.array().log().sum();
        W_ = cholesky.solve(MatrixXd::Identity(L, L));
        d_ = (X_ * W_).cwiseProduct(X_).rowwise().sum();
        return true;
    }

  private:
    /// Adds (sign 1) or takes away (sign -1) a row; the changes of d_ij are -result c_i c_j with
    /// c = change_.
    double update(Index candidate, double sign) {
        const VectorXd u = W_ * X_.row(candidate).transpose();
        change_.noalias() = X_ * u;
        const double scale = sign / (1 + sign * d_[candidate]);
        W_.noalias() -= scale * u * u.transpose();
        d_ -= scale * change_.cwiseAbs2();
        return scale;
    }

    const MatrixXd& X_;
    std::vector<Index> poses_;
    MatrixXd W_;
    VectorXd d_;
    VectorXd open_;
    VectorXd change_;
    double ridge_ = 0;
    double log_det_ = 0;
    int exchanges_ = 0;
};

struct Exchange {
    Index at = -1;  // of the choice
    Index in = -1;  // candidate
    double gain = least_gain;
};

/// Keeps the better of `best` and the best candidate in place of pose `at`, whose d_ij are `c`.
template <typename Covariances>
void keep_best(const Design& design, Index at, const Covariances& c, VectorXd& gains,
               Exchange& best) {
    const double left = 1 - design.d()[design.pose(at)];
    gains = design.open().array() * ((1 + design.d().array()) * left + c.array().square());
    if (!(gains.maxCoeff() > best.gain)) return;
    best.at = at;
    best.gain = gains.maxCoeff(&best.in);
}

/// The best of all pairs, until none improves [Fedorov 1972], as AlgDesign's optFederov.
template <typename IsOver>
void exchange_by_fedorov(Design& design, const IsOver& is_over) {
    MatrixXd C = design.covariances();
    VectorXd gains;
    while (!is_over()) {
        Exchange best;
        for (Index at = 0; at < design.size(); ++at) {
            keep_best(design, at, C.col(at), gains, best);
        }
        if (best.at < 0) return;
        design.exchange(best.at, best.in, &C);
    }
}

/// The best candidate for each pose in turn [Cook, Nachtsheim 1980].
template <typename IsOver>
void exchange_in_turn(Design& design, const IsOver& is_over) {
    VectorXd c;
    VectorXd gains;
    Index unimproved = 0;
    for (Index at = 0; unimproved < design.size() && !is_over(); at = (at + 1) % design.size()) {
        c.noalias() = design.rows() * (design.W() * design.rows().row(design.pose(at)).transpose());
        Exchange best;
        keep_best(design, at, c, gains, best);
        if (best.at >= 0) design.exchange(best.at, best.in);
        unimproved = best.at >= 0 ? 0 : unimproved + 1;
    }
}

/// Positions of the `count` smallest keys, ascending.
inline std::vector<Index> smallest(const VectorXd& keys, Index count) {
    std::vector<Index> order(static_cast<std::size_t>(keys.size()));
    std::iota(order.begin(), order.end(), Index{0});
    count = std::min(count, keys.size());
    std::partial_sort(order.begin(), order.begin() + count, order.end(),
                      [&](Index a, Index b) { return keys[a] < keys[b]; });
    order.resize(static_cast<std::size_t>(count));
    return order;
}

/// The best pair of the K chosen candidates of least variance and the L others of most
/// [Atkinson, Donev, Tobias 2007, ch. 12].
template <typename IsOver>
void exchange_by_kl(Design& design, Index K, Index L, const IsOver& is_over) {
    while (!is_over()) {
        VectorXd chosen(design.size());
        for (Index at = 0; at < chosen.size(); ++at) chosen[at] = design.d()[design.pose(at)];
        const VectorXd others = -design.d().cwiseProduct(design.open());
        const std::vector<Index> ins =
            smallest(others, std::min(L, design.rows().rows() - design.size()));
        const MatrixXd X = design.rows()(ins, Eigen::all);
        Exchange best;
        for (const Index at : smallest(chosen, K)) {
            const VectorXd c = X * (design.W() * design.rows().row(design.pose(at)).transpose());
            for (Index k = 0; k < c.size(); ++k) {
                const Index in = ins[static_cast<std::size_t>(k)];
                const double gain = (1 + design.d()[in]) * (1 - chosen[at]) + c[k] * c[k];
                if (gain > best.gain) best = {at, in, gain};
            }
        }
        if (best.at < 0) return;
        design.exchange(best.at, best.in);
    }
}

/// Some random candidates, then always the one of most variance, M made regular by a small ridge
/// [Atkinson, Donev, Tobias 2007, ch. 12].
inline bool start_sequentially(Design& design, Index n, RandomStream& random) {
    const MatrixXd& X = design.rows();
    const Index drawn = 1 + random.index(std::max<Index>(1, X.cols() / 2));
    const double ridge = 1e-6 * X.squaredNorm() / static_cast<double>(X.size());
    design.start(random.subset(X.rows(), std::min(drawn, n)), ridge);
    while (design.size() < n) {
        Index in = 0;
        design.d().cwiseProduct(design.open()).maxCoeff(&in);
        design.append(in);
    }
    return design.start(design.poses());
}

/// Random candidates, drawn again while they are singular; sequentially after fifty such draws.
inline bool start_randomly(Design& design, Index n, RandomStream& random) {
    for (int draw = 0; draw < 50; ++draw) {
        if (design.start(random.subset(design.rows().rows(), n))) return true;
    }
    return start_sequentially(design, n, random);
}

/// One or the other, by chance.
inline bool start_either_way(Design& design, Index n, RandomStream& random) {
    return random.index(2) == 0 ? start_randomly(design, n, random)
                                : start_sequentially(design, n, random);
}

/// The best log det of `descend(design, random, is_over)` again and again, on every thread, until
/// the time (s) is up. A descent cut short counts with what it has reached.
template <typename Descend>
double restart_for(double seconds, const MatrixXd& X, std::uint64_t seed, const Descend& descend) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    const auto is_over = [&] { return Clock::now() >= end; };
    double best = -std::numeric_limits<double>::infinity();
#pragma omp parallel
    {
        RandomStream random(seed, static_cast<std::uint64_t>(omp_get_thread_num()));
        Design design(X);
        while (!is_over()) {
            descend(design, random, is_over);
            design.refresh();
#pragma omp critical(posewise_reference_outcome)
            best = std::max(best, design.log_det());
        }
    }
    return best;
}

}  // namespace posewise::reference
