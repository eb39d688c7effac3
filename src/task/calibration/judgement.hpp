#pragma once

#include "core/names.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/judgement.hpp"
#include "task/doubt/nominal_residuals.hpp"

namespace posewise::detail {

inline constexpr Names<LimitVerdict, 3> limit_verdicts{{{LimitVerdict::Kept, "pass"},
                                                        {LimitVerdict::NotKept, "fail"},
                                                        {LimitVerdict::Open, "undecided"}}};

/// What poses were judged with: a robot calibrated at other ones.
struct Judge {
    const Campaign& campaign;  ///< with the model error found
    const Estimate& estimate;
    const RowMatrixXd& calibrated_with;  ///< configurations
    /// Whether the estimate's covariance tells what to expect there.
    bool knows_expected = true;
    Index fitted_count = 0;  ///< of base and targets, fitted to the poses that are judged
    const NominalRobot* nominal = nullptr;  ///< to compare with, if it is known
};

Judgement judge(const Judge& judge, const Measurements& others);

}  // namespace posewise::detail
