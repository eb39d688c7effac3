#pragma once

#include <string>
#include <vector>

#include "posewise/calibrator/identification.hpp"

namespace posewise {

/// Some of a robot's error parameters, as a model to choose.
struct ParameterSet {
    std::string name;
    std::vector<std::string> parameters;  ///< the chain's, by name
};

/// The chain's parameters in steps, each set holding the one before it: none (base and targets
/// only), joint offsets (constant errors of what joints drive), + lengths (other constant errors
/// along an axis), + other geometric, + gravity terms, + free terms, + harmonics. Steps that add
/// nothing are left out.
std::vector<ParameterSet> nested_parameter_sets(const Chain& chain);

/// One parameter set, calibrated. Distances are those of the means of configurations, m.
struct ModelTrial {
    ParameterSet set;
    Index parameter_count = 0;  ///< with base and targets
    double fit_rms = 0;         ///< all configurations used
    double held_out_rms = 0;    ///< each group predicted from the others
    double standard_error = 0;  ///< of held_out_rms, over configurations
    std::string failure = {};   ///< why there are no figures; empty: there are
};

struct ModelSelection {
    Index folds = 0;
    std::vector<ModelTrial> trials;  ///< smallest set first
    Index best = -1;                 ///< of least held-out error; -1: no set could be identified
    /// The smallest set within one standard error of the best [Breiman et al. 1984, sec. 3.4.3].
    Index recommended = -1;
    /// Under a robust loss: outliers of the largest set that could be identified. They take part in
    /// every calibration but judge none.
    std::vector<Outlier> not_judged;
};

/// Calibrates each of nested_parameter_sets() and compares the mean squared held-out errors, as
/// cross_validate() finds them. The standard error of a mean takes each configuration as one draw:
/// with S_i the sum over its n_i points, N points in m configurations,
/// sqrt(m / (m - 1) sum (S_i - mean n_i)^2) / N [Cochran 1977, ch. 6].
/// `registered` is what register_base_and_targets() found; every identification begins there.
/// `progress` is that of the sets.
/// Throws InputError for folds as cross_validate() does.
ModelSelection select_model(const Campaign& campaign, const Measurements& measurements,
                            const Parameters& registered, Index folds,
                            const LevenbergMarquardtOptions& options = {},
                            const ProgressCallback& progress = {});

}  // namespace posewise
