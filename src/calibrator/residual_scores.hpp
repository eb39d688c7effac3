#pragma once

#include <optional>
#include <vector>

#include "least_squares.hpp"

/// Questions to the residuals of a fit that need no other fit: what is left without a
/// configuration, and whether they follow columns that the model does not have.
namespace posewise::detail {

/// A linearised fit at its optimum. With B the whitened rows of the observations, P the prior's
/// information and M = B^T B + P, residuals are W y with W = I - B M^-1 B^T, which is the inverse
/// of the observations' covariance, prior included.
struct LinearFit {
    RowMatrixXd U;                     ///< rows x parameters: B M^-1 B^T = U U^T
    VectorXd e;                        ///< residuals, whitened
    std::vector<Index> first_row{0};   ///< of each configuration, and one more
    std::vector<bool> is_length = {};  ///< of each row: a length, else an angle

    Index count() const { return static_cast<Index>(first_row.size()) - 1; }
    Index begin(Index i) const { return first_row[static_cast<std::size_t>(i)]; }
    Index rows(Index i) const { return begin(i + 1) - begin(i); }
};

/// How surely the robot's errors are known to be small.
enum class FitPrior {
    AsIdentified,   ///< as the identification took it
    ExpectedSizes,  ///< by the expected sizes, also where these were no prior
};

/// The fit about these parameters, an optimum or near one. Nothing if it is not regular.
std::optional<LinearFit> linear_fit(const IdentificationProblem& problem,
                                    const Parameters& parameters,
                                    FitPrior prior = FitPrior::AsIdentified);

/// What a configuration's rows are off by if all the others predict them, W_ii^-1 e_i, and by how
/// much the sum of squares falls without it, e_i^T W_ii^-1 e_i.
struct LeftOut {
    VectorXd residuals;
    double squares = 0;
};
LeftOut leave_out(const LinearFit& fit, Index configuration);

/// Mean square of the lengths (of the angles, where no length is measured) of configurations when
/// each is left out, over that of the same residuals in the fit.
double held_out_ratio(const LinearFit& fit);
/// Sum of these squares over some configurations.
double held_out_squares(const LinearFit& fit, const std::vector<Index>& configurations);

/// The score test of columns X beside those of the model [Rao 1948]. What the residuals say of them
/// is b = V^-1 X^T e with V = X^T W X. Their variance is taken as `scale` times what it would be
/// by the noise as stated, plus that by the prior; the scale is found from the residuals that are
/// left with X, each configuration's part of the score one independent number: within one they may
/// depend on each other in any way. Where few configurations have rows of X, it may be found from
/// the residuals of all instead.
struct Score {
    Index columns = 0;     ///< that the model cannot take up
    double statistic = 0;  ///< about `columns` times F(columns, freedom) if there is nothing
    double freedom = 0;    ///< of the scale: effective configurations
    double scale = 0;
    VectorXd effect;      ///< b, in the units of X
    VectorXd deviations;  ///< standard deviations of b
    LinearFit with;       ///< the fit with X beside the parameters

    /// Whether chance would do it with less than this probability.
    bool is_beyond(double chance) const;
};
enum class ScaleFrom { Score, AllResiduals };
/// `prior_scale`: of the variance by the prior.
Score score(const LinearFit& fit, const RowMatrixXd& X, double prior_scale = 1,
            ScaleFrom scale_from = ScaleFrom::Score);

/// The rows of X from one of these configurations on, 0 before.
RowMatrixXd from_member(const LinearFit& fit, const RowMatrixXd& X,
                        const std::vector<Index>& members, Index first);

/// Which of `members` (configurations, ascending) is the likeliest that X sets in at: at least
/// `least` of them on both sides. The statistic is that of the score with scale 1.
struct ChangePoint {
    Index first = 0;       ///< position among the members
    double statistic = 0;  ///< 0: there is none
};
ChangePoint find_change_point(const LinearFit& fit, const RowMatrixXd& X,
                              const std::vector<Index>& members, Index least);

}  // namespace posewise::detail
