#include "refinement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/decompositions.hpp"
#include "core/elementary.hpp"
#include "core/nlopt_adapter.hpp"
#include "core/products.hpp"
#include "pose_merit.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

constexpr int no_limit = std::numeric_limits<int>::max();

/// What is maximised: D as it is, the others' logarithm, so that differences are relative.
double merit_of(const Objective& objective, double value) {
    return is_logarithm(objective.criterion) || !std::isfinite(value) ? value : logarithm(value);
}
double merit(const Objective& objective, const MatrixXd& M) {
    return merit_of(objective, evaluate(objective, M));
}

/// The merit and the symmetric Z with d merit = trace(Z dM).
struct SlopedMerit {
    double value = 0;
    MatrixXd Z;
};

SlopedMerit sloped_merit(const Objective& objective, const MatrixXd& M) {
    SlopedMerit merit;
    merit.Z = gradient(objective, M, &merit.value);
    if (is_logarithm(objective.criterion) || !std::isfinite(merit.value)) return merit;
    merit.Z /= merit.value;
    merit.value = logarithm(merit.value);
    return merit;
}

/// A plan on its way.
class Refiner {
  public:
    Refiner(const DesignSpace& space, const HeldPoses& held, const RowMatrixXd& start,
            const RefineOptions& options)
        : space_(space),
          held_(held),
          held_information_(information_of(held.rows, space.parameter_count)),
          options_(options),
          poses_(start),
          // What is to beat a plan has all its poses but a few at rest already.
          is_swept_(std::isfinite(options.worth)) {
        for (Index i = 0; i < start.rows(); ++i) informations_.push_back(information(pose(i)));
    }

    const RowMatrixXd& poses() const { return poses_; }
    Ending ending() const { return ending_; }
    bool has_stopped() const { return options_.stop.is_set(); }

    /// Held information and that of all poses but one; -1: of all. Summed anew each time, so that
    /// rounding does not pile up.
    MatrixXd information_without(Index skipped) const {
        MatrixXd M = held_information_;
        for (std::size_t i = 0; i < informations_.size(); ++i) {
            if (static_cast<Index>(i) != skipped) M += informations_[i];
        }
        return M;
    }

    double current(const Objective& objective) const {
        return merit(objective, information_without(-1));
    }

    /// Rounds until a round gains no more than the tolerance. Free poses are swept only at first.
    void climb(const Objective& objective, double tolerance) {
        tolerance_ = tolerance;
        ending_ = Ending::IterationLimit;
        for (const Index i : options_.moved) move_one(objective, i, Method::Lbfgs);
        if (!options_.moved.empty()) return;
        for (Index round = 0; round < options_.round_limit && !has_stopped(); ++round) {
            const double before = current(objective);
            if (is_constrained() || !is_swept_) sweep(objective, Method::Lbfgs);
            is_swept_ = true;
            if (round == 0 && !is_promising(objective)) return;
            if (moves_together_) move_together(objective);
            const double after = current(objective);
            // Along constraints a round is the first step.
            if (round == 0 && is_constrained() && !is_near_worth(objective, before, after)) return;
            if (after - before > tolerance) continue;
            ending_ = Ending::Converged;
            return;
        }
    }

    /// Sweeps without derivatives, for objectives with kinks.
    void finish(const Objective& objective) {
        for (Index round = 0; round < options_.kink_rounds && !has_stopped(); ++round) {
            const double before = current(objective);
            sweep(objective, is_constrained() ? Method::Cobyla : Method::Sbplx);
            if (current(objective) - before <= 1e-6) return;
        }
    }

    /// The smallest margin of pose i at q: of the pose, and of its distance to the others.
    double margin(Index i, const VectorXd& q) const {
        double least = space_.margin ? space_.margin(q) : 0;
        if (space_.least_joint_distance <= 0) return least;
        const auto keep_away = [&](const RowMatrixXd& others, Index skipped) {
            for (Index k = 0; k < others.rows(); ++k) {
                if (k == skipped) continue;
                const double distance = joint_distance(others.row(k).transpose(), q);
                least = std::min(least, distance - space_.least_joint_distance);
            }
        };
        keep_away(poses_, i);
        keep_away(held_.configurations, -1);
        return least;
    }

  private:
    /// Whether first steps of all poses together come near what it is worth to go on for.
    bool is_promising(const Objective& objective) {
        constexpr int first_steps = 20;
        if (std::isinf(options_.worth) || is_constrained()) return true;
        const double before = current(objective);
        move_together(objective, first_steps);
        return is_near_worth(objective, before, current(objective));
    }

    /// Whether less is missing than half of what was gained.
    bool is_near_worth(const Objective& objective, double before, double after) const {
        if (std::isinf(options_.worth)) return true;
        return merit_of(objective, options_.worth) - after <= 0.5 * (after - before);
    }

    bool is_constrained() const { return space_.margin || space_.least_joint_distance > 0; }
    VectorXd pose(Index i) const { return poses_.row(i).transpose(); }
    MatrixXd information(const VectorXd& q) const { return space_.information(q); }

    void place(Index i, const VectorXd& q) {
        poses_.row(i) = q.transpose();
        informations_[static_cast<std::size_t>(i)] = information(q);
    }

    MaximiseOptions maximise_options(Method method) const {
        // Measured on D-optimal plans of a 6R robot (24 poses, 8 starts): L-BFGS ends at log det
        // 303.351 on average after 0.14 s, MMA at 303.328 after 0.34 s, SLSQP at 303.324 after 2.7
        // s, since it solves a dense least-squares problem of all joint values every step.
        MaximiseOptions options;
        options.method = method;
        options.value_tolerance = tolerance_ / 100;
        options.evaluation_limit = options_.evaluation_limit;
        options.stop = options_.stop;
        if (method != Method::Lbfgs) {
            options.value_tolerance = 1e-9;
            options.first_step = 0.05;
            options.evaluation_limit = std::min(options_.evaluation_limit, 100);
        }
        return options;
    }

    void sweep(const Objective& objective, Method method) {
        for (Index i = 0; i < poses_.rows() && !has_stopped(); ++i) move_one(objective, i, method);
    }

    double quick_merit(const PoseMerit& quick, const VectorXd& q, VectorXd* slope) const {
        if (slope == nullptr) return quick.evaluate(space_.rows(q));
        double value = 0;
        *slope = space_.weighed_gradient(q, [&](const RowMatrixXd& B) {
            RowMatrixXd BZ;
            value = quick.evaluate(B, &BZ);
            return BZ;
        });
        return value;
    }

    /// The best place of pose i with the others at rest.
    void move_one(const Objective& objective, Index i, Method method) {
        const MatrixXd rest = information_without(i);
        BoxProblem problem;
        problem.lower = space_.lower;
        problem.upper = space_.upper;
        const auto quick = space_.weighed_gradient
                               ? PoseMerit::make(objective, rest, space_.rows(pose(i)))
                               : std::nullopt;
        problem.value = [&](const VectorXd& q, VectorXd* slope) {
            if (quick) {
                const double value = quick_merit(*quick, q, slope);
                if (std::isfinite(value)) return value;
            }
            const MatrixXd M = rest + information(q);
            if (slope == nullptr) return merit(objective, M);
            const SlopedMerit sloped = sloped_merit(objective, M);
            *slope = space_.information_gradient(q, sloped.Z);
            return sloped.value;
        };
        const VectorXd start = pose(i);
        VectorXd best = start;
        if (method == Method::Lbfgs) {
            const VectorXd free = maximise(problem, start, maximise_options(Method::Lbfgs)).x;
            if (!is_constrained() || margin(i, free) >= 0) {
                place(i, free);
                return;
            }
            const VectorXd edge = last_feasible(i, start, free);
            if (problem.value(edge, nullptr) > problem.value(start, nullptr)) best = edge;
            method = Method::Cobyla;
        }
        if (is_constrained()) problem.margin = [&](const VectorXd& q) { return margin(i, q); };
        place(i, maximise(problem, best, maximise_options(method)).x);
    }

    /// The last feasible point of pose i found by bisection from a feasible start to an end.
    VectorXd last_feasible(Index i, const VectorXd& start, const VectorXd& end) const {
        double inside = 0;
        double outside = 1;
        for (int k = 0; k < 30; ++k) {
            const double t = (inside + outside) / 2;
            (margin(i, start + t * (end - start)) >= 0 ? inside : outside) = t;
        }
        return start + inside * (end - start);
    }

    /// All poses at once, then each as far as it is feasible; taken back if that is worse.
    void move_together(const Objective& objective, int most_evaluations = no_limit) {
        const Index m = poses_.rows();
        const Index n = poses_.cols();
        BoxProblem problem;
        problem.lower = space_.lower.replicate(m, 1);
        problem.upper = space_.upper.replicate(m, 1);
        problem.value = [&](const VectorXd& x, VectorXd* slope) {
            const auto at = [&](Index i) -> VectorXd { return x.segment(n * i, n); };
            Support planned;
            planned.add(space_, x.reshaped<Eigen::RowMajor>(m, n));
            const Blocks& blocks = planned.blocks;
            const MatrixXd M = held_information_ + symmetric_gram(blocks.matrix);
            if (slope == nullptr) return merit(objective, M);
            const SlopedMerit sloped = sloped_merit(objective, M);
            if (!space_.weighed_gradient || !std::isfinite(sloped.value)) {
                for (Index i = 0; i < m; ++i) {
                    slope->segment(n * i, n) = space_.information_gradient(at(i), sloped.Z);
                }
                return sloped.value;
            }
            const RowMatrixXd weighed = transposed_product(blocks.matrix.transpose(), sloped.Z);
            for (Index i = 0; i < m; ++i) {
                slope->segment(n * i, n) =
                    space_.weighed_gradient(at(i), [&](const RowMatrixXd& rows) -> RowMatrixXd {
                        return weighed.middleRows(blocks.first_row[static_cast<std::size_t>(i)],
                                                  rows.rows());
                    });
            }
            return sloped.value;
        };
        const VectorXd start = poses_.reshaped<Eigen::RowMajor>();
        MaximiseOptions maximising = maximise_options(Method::Lbfgs);
        maximising.evaluation_limit = std::min(maximising.evaluation_limit, most_evaluations);
        const VectorXd free = maximise(problem, start, maximising).x;
        if (is_constrained() && has_stopped()) return;  // distances of many poses take their time
        const double before = current(objective);
        for (Index i = 0; i < m; ++i) {
            const VectorXd end = free.segment(n * i, n);
            const bool is_free = !is_constrained() || margin(i, end) >= 0;
            place(i, is_free ? end : last_feasible(i, pose(i), end));
        }
        if (current(objective) >= before) return;
        for (Index i = 0; i < m; ++i) place(i, start.segment(n * i, n));
        moves_together_ = false;
    }

    const DesignSpace& space_;
    const HeldPoses& held_;
    MatrixXd held_information_;
    const RefineOptions& options_;
    RowMatrixXd poses_;
    std::vector<MatrixXd> informations_;
    double tolerance_ = 1e-10;
    bool is_swept_;
    bool moves_together_ = true;  ///< until it was taken back: constraints lie in between
    Ending ending_ = Ending::NotRun;
};

/// Values of the criterion for a merit.
double value_of(const Objective& objective, double merit_value) {
    return is_logarithm(objective.criterion) || !std::isfinite(merit_value)
               ? merit_value
               : exponential(merit_value);
}

void check_shape(const DesignSpace& space, const RowMatrixXd& start) {
    if (start.rows() >= 1 && start.cols() == space.joint_count() && start.allFinite()) return;
    throw InputError("a plan to refine must have at least one pose, each of " +
                     std::to_string(space.joint_count()) + " finite joint values");
}

void check_feasible(const DesignSpace& space, const RowMatrixXd& start, const Refiner& refiner) {
    for (Index i = 0; i < start.rows(); ++i) {
        const VectorXd q = start.row(i).transpose();
        const bool is_inside =
            (q.array() >= space.lower.array()).all() && (q.array() <= space.upper.array()).all();
        if (is_inside && refiner.margin(i, q) >= 0) continue;
        throw InputError("pose " + std::to_string(i + 1) +
                         " of the plan to refine is outside the limits or constraints");
    }
}

/// The better of what was and the refiner's plan, by the criterion itself.
void keep_better(const Objective& objective, const Refiner& refiner, Refinement& result) {
    const double value = value_of(objective, refiner.current(objective));
    if (!(value > result.value)) return;
    result.value = value;
    result.configurations = refiner.poses();
}

/// Climbs the smoothed objective with growing sharpness, then finishes on the objective itself.
void refine_with_kinks(const DesignSpace& space, const Objective& objective, const HeldPoses& held,
                       RefineOptions options, Refinement& result) {
    options.worth = -std::numeric_limits<double>::infinity();  // not of a smoothed objective
    Refiner smooth(space, held, result.configurations, options);
    constexpr double rough = 1e-5;
    for (const double sharpness : options.sharpness) {
        Objective smoothed = objective;
        smoothed.sharpness = sharpness;
        const bool is_last = sharpness == options.sharpness.back();
        smooth.climb(smoothed, is_last ? options.tolerance : std::max(rough, options.tolerance));
        keep_better(objective, smooth, result);
    }
    result.ending = smooth.ending();
    Refiner exact(space, held, result.configurations, options);
    exact.finish(objective);
    keep_better(objective, exact, result);
}

}  // namespace

Refinement refine_poses(const DesignSpace& space, const Objective& objective, const HeldPoses& held,
                        const RowMatrixXd& start, const RefineOptions& options) {
    check_shape(space, start);
    Refiner refiner(space, held, start, options);
    check_feasible(space, start, refiner);
    Refinement result;
    result.configurations = start;
    result.start_value = result.value = value_of(objective, refiner.current(objective));
    if (!std::isfinite(result.value)) {
        check_all_is_seen(space, rows_of(space, held, start));
        throw InputError("the plan to refine does not identify all parameters");
    }
    if (!is_smooth(objective.criterion)) {
        refine_with_kinks(space, objective, held, options, result);
    } else {
        refiner.climb(objective, options.tolerance);
        keep_better(objective, refiner, result);
        result.ending = refiner.ending();
    }
    result.ending = options.stop.ending_or(result.ending);
    return result;
}

}  // namespace posewise::detail
