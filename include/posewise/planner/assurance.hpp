#pragma once

#include "posewise/planner/prediction.hpp"

namespace posewise {

/// What of the position errors over the workspace's configurations and targets is to be small.
enum class ErrorQuantity {
    Rms,           ///< their RMS
    Percentile95,  ///< what 95 % of them are below
    Max,           ///< the largest
};

/// Where accuracy matters, and what errors of positions are by there; 3 rows a target in m, a block
/// a configuration.
struct PositionErrors {
    Blocks by_parameters;  ///< make_prediction_blocks()
    /// By the joints, times their repeatability: what differs from visit to visit. Empty: none is
    /// stated.
    Blocks by_joints;
};

/// Throws InputError as make_prediction_blocks().
PositionErrors make_position_errors(const Campaign& campaign, const RowMatrixXd& workspace,
                                    Index target = -1);

/// A position error of which it is not known yet how large it will be, m.
struct ErrorRange {
    /// RMS: with model error and sizes as the campaign expects them; else the median.
    double expected = 0;
    double lower = 0;    ///< 5 % are below
    double upper = 0;    ///< 95 %
    double assured = 0;  ///< the `assurance` asked for
};

/// The error by parameters known within M^-1 (scaled; empty: exactly) by poses of which `by_noise`
/// is, by what the model lacks and by the joints' repeatability at one visit. What is drawn is as
/// of predict_total(), the RMS by parameters by scaled chi-squared. The other quantities are those
/// of 2048 robots, whose errors of parameters, and of each position by the model and the visit, are
/// drawn from stream (seed, item). Throws InputError if M is not positive definite, or for an
/// assurance that is not above 0 and below 1.
ErrorRange predict_range(const PositionErrors& errors, const Campaign& campaign, const MatrixXd& M,
                         const InformationByNoise& by_noise, ErrorQuantity quantity,
                         double assurance, std::uint64_t seed = 1);

/// What the expected RMS consists of, m; squares add up.
struct ErrorBudget {
    double noise = 0;  ///< of the parameters: by the sensor's noise (and the joints', measuring)
    double model = 0;  ///< of the parameters: by the model error at the poses measured
    double prior = 0;  ///< of the parameters: what poses leave of their prior
    double parameters = 0;     ///< these three
    double left_over = 0;      ///< what the model cannot express, at the positions themselves
    double repeatability = 0;  ///< of the joints, at one visit
    double total = 0;
};

/// M of the whole plan (empty: parameters known exactly), `by_noise` of the poses to measure.
ErrorBudget make_budget(const PositionErrors& errors, const Campaign& campaign, const MatrixXd& M,
                        const InformationByNoise& by_noise);

/// A pose that is missing.
struct DropOut {
    Index pose = 0;
    double rms = 0;  ///< without it, by the parameters, m; infinity: some are left unidentified
};

/// Each of the poses (their blocks, part of M) missing alone.
std::vector<DropOut> drop_each(const Blocks& prediction, const Blocks& poses, const MatrixXd& M);

/// So many poses dropped one after another, each the one that then hurts most (greedy); fewer where
/// parameters are left unidentified, or no pose is left. M becomes that without them.
std::vector<DropOut> drop_worst(const Blocks& prediction, const Blocks& poses, Index count,
                                MatrixXd& M);

}  // namespace posewise
