#pragma once

#include <functional>

#include "loss.hpp"
#include "parameter_units.hpp"
#include "posewise/calibrator/estimate.hpp"

namespace posewise::detail {

/// The identification as a linearised least-squares problem, whitened and scaled: minimise
/// |J d - r|^2 over the scaled step d, rows = equations: observations, then the prior's. The rows
/// of a target are multiplied by the square root of its weight under the loss.
struct LinearisedSystem {
    RowMatrixXd augmented;            ///< equations x (L + 1): J, then r
    std::vector<Index> first_row{0};  ///< one for each configuration, then the prior's

    auto J() const { return augmented.leftCols(augmented.cols() - 1); }
    auto r() const { return augmented.col(augmented.cols() - 1); }  ///< observed less predicted
};

/// The measured means and what every linearisation of them shares.
struct IdentificationProblem {
    const Campaign& campaign;
    const Measurements& measurements;
    Measurements means;   ///< one sample a configuration
    RowMatrixXd repeats;  ///< configurations x targets: samples of each mean
    ParameterUnits units;
    Loss loss = {};
    double deviation = 1;  ///< unit of the loss, in standard deviations as stated

    /// Numbers observed: those of the targets seen.
    Index observation_count() const { return seen_row_count(*campaign.sensor, means.is_seen); }
    /// One equation for each parameter that has a prior: its coordinate is 0, give or take 1.
    Index prior_begin() const { return posewise::prior_begin(campaign); }
    Index prior_count() const { return posewise::prior_count(campaign); }
    Index equation_count() const { return observation_count() + prior_count(); }
};

/// Throws InputError if the measurements do not fit the campaign (count of joints, columns or
/// targets).
IdentificationProblem make_problem(const Campaign& campaign, const Measurements& measurements);

/// Says that a target whose position is unknown is seen in no sample, by its number; empty if there
/// is none, or an earlier estimate that is the prior tells where they are.
std::string describe_unseen_target(const Campaign& campaign, const Measurements& measurements);

/// The same, or that there are fewer equations than parameters.
std::string describe_missing_equations(const IdentificationProblem& problem);

/// How many equations a configuration has.
enum class Equations {
    /// As many as tell the same: of a camera that sees 40 corners, and whose intrinsic parameters
    /// are unknown, 16. Only where it pays, and where all numbers observed are of one kind.
    Fewest,
    All,  ///< one for each number observed
};

/// Whether the fewest equations are at most half as many as the numbers observed.
bool pays_narrowly(const Sensor& sensor, const Parameters& parameters);

LinearisedSystem linearise(const IdentificationProblem& problem, const Parameters& parameters,
                           Equations equations = Equations::Fewest);

/// Writes columns of one configuration: all rows of an observation, in m or rad.
using FillColumns = std::function<void(Index configuration, Eigen::Ref<RowMatrixXd> columns)>;
/// The same rows of `count` columns that are no parameter's: of the targets seen, whitened and
/// weighted as linearise() does it.
RowMatrixXd whitened_columns(const IdentificationProblem& problem, const Parameters& parameters,
                             Index count, const FillColumns& fill);

/// Length of the whitened mean residual of each target seen, one configuration after another: in
/// standard deviations of one coordinate, as stated. Where errors of the joints correlate targets,
/// a target's is what those before it leave open.
/// `noise_at` (nullptr: `parameters`) are those at which the noise is taken where it depends on the
/// pose: it must not change between two sums that are compared, or larger noise would count as a
/// better fit.
VectorXd residual_lengths(const IdentificationProblem& problem, const Parameters& parameters,
                          const Parameters* noise_at = nullptr);

/// The loss of all targets, with squares chi^2, and the sum of squares of what the prior says.
double total_loss(const IdentificationProblem& problem, const Parameters& parameters,
                  const Parameters* noise_at = nullptr);

/// What a step must gain of a sum of squares, `cost`, to be worth taking: a part of it, and more
/// than rounding is, residuals of 1e-10 standard deviations. Beside an earlier estimate as prior a
/// thousandth of a standard deviation: its narrow valleys are followed in many small steps.
double converged_below(const IdentificationProblem& problem, double relative_tolerance,
                       double cost);

/// J reduced to its triangle by Householder QR: |J d - r|^2 = |R d - c|^2 + rest.
struct Triangle {
    MatrixXd R;          ///< L x L, upper
    VectorXd c;          ///< L
    double squares = 0;  ///< |r|^2
};
Triangle triangularise(const LinearisedSystem& system);

/// Inverse of an upper triangle.
MatrixXd invert_triangle(const MatrixXd& R);

/// The largest parameters in a direction of parameter space that these configurations do not see (a
/// singular value of the column-normalised Jacobian below 1e-9 of the largest, with the robot at
/// nominal, where a lost rank is exactly lost). Empty: there is none.
std::vector<Index> confused_parameters(const IdentificationProblem& problem,
                                       const Parameters& parameters);

/// "base.z, target1.z".
std::string name_parameters(const Campaign& campaign, const std::vector<Index>& parameters);

/// What keeps all parameters from being identified, as a sentence: equations that are missing, or
/// the confused parameters and what to do about them. Empty: all are identifiable.
std::string describe_undetermined(const IdentificationProblem& problem,
                                  const Parameters& parameters);

/// An estimate at `start` that has not run, or that says why it cannot.
Estimate begin_estimate(const IdentificationProblem& problem, const Parameters& start);

/// Fills covariance, variance factors and metrics of an estimate from its parameters, where the
/// system is `system`.
void finish(const IdentificationProblem& problem, const LinearisedSystem& system,
            Estimate& estimate);

}  // namespace posewise::detail
