#pragma once

#include <vector>

#include "calibrator/residual_scores.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise::detail {

/// Chances that something is seen where there is nothing, each of a whole campaign.
constexpr double chance_of_outlying = 1e-3;
constexpr double chance_of_change = 1e-3;
constexpr double chance_of_joint = 1e-3;
constexpr double chance_of_factor = 3e-3;
/// A pattern is named where it matters: the mean square that is held out falls to this part of it.
constexpr double material = 0.7;

/// An estimate and the measurements that it is of.
struct Fitted {
    const Campaign& campaign;  ///< as it was identified from: with the model error stated
    Measurements measured;
    Estimate estimate;
};

/// Identified anew as calibrate() does. Nothing if that is not possible.
std::optional<Fitted> fit_again(const Campaign& campaign, const Measurements& measured,
                                const Loss& loss);

/// The linearised fit of an estimate, and its problem.
struct FittedProblem {
    explicit FittedProblem(const Fitted& fitted);
    Campaign found;  ///< with the model error found
    IdentificationProblem problem;
};

/// RMS that configurations left out one by one are missed by, m or rad.
double held_out_rms(const Fitted& fitted);

/// Columns that residuals may follow, beside those of the parameters.
class PatternColumns {
  public:
    PatternColumns(const FittedProblem& fitted, const Parameters& parameters);

    RowMatrixXd base() const { return all_.leftCols(6); }  ///< translation, then rotation
    RowMatrixXd joint(Index j) const { return all_.col(6 + j); }
    RowMatrixXd unknowns(const std::vector<Index>& which) const;
    RowMatrixXd lengths() const { return all_.col(lengths_); }
    /// What three lengths of a target would all be off by, along the instrument's axes; none where
    /// it reads others.
    RowMatrixXd shift() const { return all_.rightCols(all_.cols() - lengths_ - 1); }

  private:
    Index first_unknown_;
    Index lengths_;
    RowMatrixXd all_;
};

/// Whether readings hold lengths, not only that something is touched.
bool tells_lengths(const Sensor& sensor);

/// Steps and drifts of base, targets and sockets; what is found is beside the parameters in `fit`
/// from then on.
std::vector<SetUpChange> find_set_up_changes(const Fitted& fitted, const PatternColumns& columns,
                                             LinearFit& fit);
std::vector<JointPattern> find_joint_patterns(const Fitted& fitted, const PatternColumns& columns,
                                              const LinearFit& fit);
std::optional<LengthFactor> find_length_factor(const Fitted& fitted, const PatternColumns& columns,
                                               const LinearFit& fit);
std::optional<RoundedJoints> find_rounded_joints(const Fitted& fitted);
std::optional<RoundedReadings> find_rounded_readings(const Fitted& fitted);

}  // namespace posewise::detail
