#include "nlopt_adapter.hpp"

#include <nlopt.h>

#include <cmath>
#include <exception>
#include <memory>
#include <new>

namespace posewise::detail {
namespace {

nlopt_algorithm algorithm_of(Method method) {
    switch (method) {
        case Method::Sbplx:
            return NLOPT_LN_SBPLX;
        case Method::Cobyla:
            return NLOPT_LN_COBYLA;
        default:
            return NLOPT_LD_LBFGS;
    }
}

Ending ending_of(nlopt_result result) {
    switch (result) {
        case NLOPT_SUCCESS:
        case NLOPT_STOPVAL_REACHED:
        case NLOPT_FTOL_REACHED:
        case NLOPT_XTOL_REACHED:
            return Ending::Converged;
        case NLOPT_MAXEVAL_REACHED:
        case NLOPT_FORCED_STOP:  // out of patience; that the caller asked to stop comes first
            return Ending::IterationLimit;
        case NLOPT_ROUNDOFF_LIMITED:
            return Ending::RoundoffLimited;
        default:
            return Ending::Failed;
    }
}

/// One run: what NLopt's callbacks share. C++ exceptions must not pass through C frames, so the
/// first one is kept and the run stopped.
struct Run {
    const BoxProblem& problem;
    const MaximiseOptions& options;
    nlopt_opt handle;
    double outside;  ///< finite stand-in for minus infinity, which line searches cannot take
    Maximum best;
    int since_best = 0;
    VectorXd x;
    VectorXd gradient;
    std::exception_ptr error;

    Run(const BoxProblem& boxed, const MaximiseOptions& how, nlopt_opt nlopt, const VectorXd& start,
        double value)
        : problem(boxed),
          options(how),
          handle(nlopt),
          outside(value - 100 * (1 + std::abs(value))),
          x(start),
          gradient(start) {
        best.x = start;
        best.value = value;
    }

    bool is_feasible() const { return !problem.margin || problem.margin(x) >= 0; }

    double evaluate(const double* point, double* slope) {
        x = Eigen::Map<const VectorXd>(point, x.size());
        const double value = problem.value(x, slope == nullptr ? nullptr : &gradient);
        if (slope != nullptr) Eigen::Map<VectorXd>(slope, x.size()) = gradient;
        ++since_best;
        if (value > best.value && is_feasible()) {
            best.x = x;
            best.value = value;
            since_best = 0;
        }
        if (since_best > options.patience) nlopt_force_stop(handle);
        if (options.stop.is_set()) nlopt_force_stop(handle);
        return std::isfinite(value) ? value : outside;
    }
};

/// Calls f, which gives a double; after an exception, stops the run.
template <typename Function>
double guarded(Run& run, const Function& f) {
    try {
        return f();
    } catch (...) {
        if (!run.error) run.error = std::current_exception();
        nlopt_force_stop(run.handle);
        return run.outside;
    }
}

double value_callback(unsigned, const double* x, double* gradient, void* data) {
    Run& run = *static_cast<Run*>(data);
    return guarded(run, [&] { return run.evaluate(x, gradient); });
}

/// NLopt's constraints are "at most zero".
double margin_callback(unsigned size, const double* x, double*, void* data) {
    Run& run = *static_cast<Run*>(data);
    return guarded(run, [&] {
        return -run.problem.margin(Eigen::Map<const VectorXd>(x, static_cast<Index>(size)));
    });
}

}  // namespace

Maximum maximise(const BoxProblem& problem, const VectorXd& start, const MaximiseOptions& options) {
    const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> handle(
        nlopt_create(algorithm_of(options.method), static_cast<unsigned>(start.size())),
        nlopt_destroy);
    if (!handle) throw std::bad_alloc();
    Run run(problem, options, handle.get(), start, problem.value(start, nullptr));
    nlopt_set_max_objective(run.handle, value_callback, &run);
    nlopt_set_lower_bounds(run.handle, problem.lower.data());
    nlopt_set_upper_bounds(run.handle, problem.upper.data());
    nlopt_set_ftol_rel(run.handle, options.value_tolerance);
    nlopt_set_xtol_abs1(run.handle, options.step_tolerance);
    nlopt_set_maxeval(run.handle, options.evaluation_limit);
    if (options.first_step > 0) nlopt_set_initial_step1(run.handle, options.first_step);
    if (options.method == Method::Cobyla && problem.margin) {
        nlopt_add_inequality_constraint(run.handle, margin_callback, &run, 0);
    }
    VectorXd x = start;
    double reported = 0;  // by NLopt, and not believed: `best` was evaluated by ourselves
    const nlopt_result result = nlopt_optimize(run.handle, x.data(), &reported);
    if (run.error) std::rethrow_exception(run.error);
    run.best.ending = options.stop.ending_or(ending_of(result));
    return run.best;
}

}  // namespace posewise::detail
