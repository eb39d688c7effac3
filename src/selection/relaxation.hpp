#pragma once

#include "bound.hpp"

namespace posewise::detail {

/// The continuous relaxation: weights between 0 and the repeat limit that sum to K.
struct Relaxation {
    VectorXd weights;         ///< of every candidate
    Certificate certificate;  ///< the best one met
    double bound = std::numeric_limits<double>::infinity();
    VectorXd sensitivity;  ///< of every candidate at the certificate
    Index iterations = 0;
};

/// Maximises the (softened) objective over the weights by spectral projected gradient [Birgin,
/// Martinez, Raydan 2000] on a working set of candidates; all candidates are priced between rounds
/// and the most sensitive join the set, until the bound is within options.gap of the value.
/// Criteria that are not smooth are sharpened step by step. options.stop is asked between steps.
/// `start`: weights of all candidates to begin with, which sum to K; empty: all the same.
Relaxation relax(const Objective& objective, const Blocks& candidates, const SelectOptions& options,
                 const VectorXd& start = {});

}  // namespace posewise::detail
