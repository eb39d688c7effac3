#pragma once

#include <functional>

#include "posewise/core/progress.hpp"
#include "posewise/core/types.hpp"

/// All use of NLopt is behind this header.
namespace posewise::detail {

/// Maximise value(x) in a box, where feasible.
struct BoxProblem {
    /// The value, and its gradient if the pointer is not null. Minus infinity: outside the domain.
    std::function<double(const VectorXd& x, VectorXd* gradient)> value;
    /// At least 0 where x is feasible; empty: everywhere. Only Cobyla looks at it.
    std::function<double(const VectorXd& x)> margin;
    VectorXd lower;
    VectorXd upper;  ///< equal to lower: that coordinate stays
};

enum class Method {
    Lbfgs,   ///< gradients, bounds
    Sbplx,   ///< derivative-free, bounds
    Cobyla,  ///< derivative-free, bounds and margin
};

struct MaximiseOptions {
    Method method = Method::Lbfgs;
    double value_tolerance = 1e-12;  ///< relative change of the value to stop at
    double step_tolerance = 1e-9;    ///< change of every coordinate to stop at
    double first_step = 0;           ///< of derivative-free methods; 0: theirs
    int evaluation_limit = 1000;
    /// Evaluations in a row without a better feasible point to give up after.
    int patience = std::numeric_limits<int>::max();
    StopSignal stop{};
};

/// The best feasible point evaluated; the start if there is none better.
struct Maximum {
    VectorXd x;
    double value = 0;
    Ending ending = Ending::NotRun;
};

/// The start must lie in the box, be feasible and have a finite value. Exceptions of `problem`
/// come out unchanged.
Maximum maximise(const BoxProblem& problem, const VectorXd& start, const MaximiseOptions& options);

}  // namespace posewise::detail
