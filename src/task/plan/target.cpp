#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "left_out.hpp"
#include "plan_maker.hpp"
#include "planner/tour.hpp"
#include "pool_choices.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/task/planning.hpp"

namespace posewise {
namespace {

using detail::PlanMaker;
using detail::PlanningProblem;
using detail::PoolChoices;

void check_target(const TargetOptions& target, const PlanningOptions& options) {
    const auto is_positive = [](double value) { return std::isfinite(value) && value > 0; };
    if (!target.limit && !target.duration) {
        throw InputError("neither a limit of the error nor a duration is stated");
    }
    if (target.limit && !is_positive(*target.limit)) {
        throw InputError(
            fmt::format("the limit of the error is {:g} m, must be positive", *target.limit));
    }
    if (target.duration && !is_positive(*target.duration)) {
        throw InputError(fmt::format("the duration is {:g} s, must be positive", *target.duration));
    }
    if (!(target.assurance > 0 && target.assurance < 1)) {
        throw InputError(
            fmt::format("assurance is {:g}, must be above 0 and below 1", target.assurance));
    }
    if (target.most_poses < 1 || target.robust_to < 0) {
        throw InputError("the number of poses must be positive, that of drop-outs not negative");
    }
    if (options.repaired) {
        throw InputError("a plan to repair has a number of poses; state that, or no such plan");
    }
}

/// The least count from `least` to `most` that `is_enough`, above which all are, too; most + 1 if
/// none is. It is looked for from `guess` on by steps that double, then bisected.
template <class IsEnough>
Index least_count(Index guess, Index least, Index most, IsEnough&& is_enough) {
    Index missing = least - 1;  // not enough, or below what there is
    Index enough = most + 1;
    Index next = std::clamp(guess, least, most);
    bool has_crossed = false;
    bool went_up = false;
    for (Index step = 1; enough - missing > 1; step *= 2) {
        const bool is_now_enough = is_enough(next);
        (is_now_enough ? enough : missing) = next;
        if (step > 1 && went_up == is_now_enough) has_crossed = true;
        went_up = !is_now_enough;
        next = is_now_enough ? enough - step : missing + step;
        if (has_crossed || next <= missing || next >= enough) next = (missing + enough) / 2;
    }
    return enough;
}

/// Counts poses by what they reach.
class Search {
  public:
    Search(const PlanMaker& maker, const PlanningOptions& options, TargetPlanning& result,
           Index least)
        : maker_(maker),
          problem_(maker.problem()),
          options_(options),
          result_(result),
          target_(result.target),
          least_(least),
          choices_(problem_.campaign, maker.pool(), problem_.request.repeats, problem_.search,
                   problem_.errors.by_parameters),
          most_(std::min(target_.most_poses, maker.pool().configurations.rows())) {}

    void run() {
        if (least_ > most_chosen()) {
            throw InputError(fmt::format(
                "{} new poses are needed at least; the pool or the most that are allowed are {}",
                least_, most_chosen()));
        }
        const Index by_choices = count_by_choices();
        if (has_limit() && by_choices > many) {
            result_.ending = TargetEnding::TooManyPoses;
            return look_for_luck();
        }
        tell(1, by_choices);
        const Index by_plans = options_.stop.is_set() ? by_choices : count_by_plans(by_choices);
        tell(2, by_plans);
        settle(by_plans);
        if (result_.ending == TargetEnding::TooManyPoses) return look_for_luck();
        look_around();
        fill_curve();
    }

    /// What no number of poses keeps with the assurance asked for, some may keep with less.
    void look_for_luck() {
        if (least_ > most_chosen()) return;
        const bool is_tried = result_.ending == TargetEnding::TooManyPoses;
        find_counts(least_, is_tried ? most_chosen() : std::min(most_chosen(), many));
        fill_curve();
    }

  private:
    /// Plans of more take minutes each, and tell hardly more than choices.
    static constexpr Index many = 200;

    bool has_limit() const { return target_.limit.has_value(); }

    /// The number so far: plans around it take most of the time.
    void tell(Index step, Index count) {
        told_ = count;
        if (options_.progress && !options_.stop.is_set()) {
            options_.progress({.done = step, .total = 20, .pose_count = count});
        }
    }

    void check_stop() const {
        std::string sought = has_limit() ? "it was found how many poses keep the target"
                                         : "it was found how many poses fit in the time";
        if (told_) sought += fmt::format(": about {}, as choices from the pool have it", *told_);
        options_.stop.check(sought);
    }

    /// Nothing: drop-outs leave parameters unidentified.
    std::optional<ErrorRange> judge(MatrixXd M, const Blocks& poses,
                                    const InformationByNoise& by_noise) const {
        if (target_.robust_to > 0) {
            const auto dropped =
                drop_worst(problem_.errors.by_parameters, poses, target_.robust_to, M);
            if (std::isinf(dropped.back().rms)) return std::nullopt;
        }
        return predict_range(problem_.errors, problem_.campaign, M, by_noise, target_.quantity,
                             target_.assurance, problem_.request.seed.value());
    }

    std::optional<ErrorRange> judge(const Planning& planning) const {
        return judge(planning.information, detail::blocks_of(problem_, planning.plan.poses),
                     planning.by_noise);
    }

    /// Whether there are enough poses for the limit; or, without one, too many for the duration.
    bool has_crossed(const std::optional<ErrorRange>& error, double duration) const {
        if (has_limit()) return error && error->assured <= *target_.limit;
        return duration > *target_.duration;
    }

    /// After a stop perhaps without an error; it is not kept then.
    CountPrediction choose(Index count) {
        const auto known = chosen_.find(count);
        if (known != chosen_.end()) return known->second;
        const CountPrediction prediction = predict(count);
        if (!options_.stop.is_set()) chosen_[count] = prediction;
        return prediction;
    }
    CountPrediction predict(Index count) const {
        CountPrediction prediction;
        prediction.pose_count = count;
        const auto chosen = choices_.choose(count, options_.stop);
        if (!chosen || options_.stop.is_set()) return prediction;
        prediction.error = judge(choices_.information(*chosen), choices_.blocks(*chosen),
                                 choices_.by_noise(*chosen));
        const double moves = detail::straight_tour_time(
            problem_.constraints, maker_.pool().configurations(*chosen, Eigen::all));
        const Seen is_seen = maker_.pool().is_seen(*chosen, Eigen::all);
        prediction.duration = detail::campaign_time(problem_, moves, is_seen).total;
        return prediction;
    }

    bool is_crossed_by_choice(Index count) {
        check_stop();
        const CountPrediction prediction = choose(count);
        return has_crossed(prediction.error, prediction.duration);
    }
    Index most_chosen() const { return std::min(most_, choices_.candidate_count()); }
    Index count_by_choices() {
        return least_count(least_, least_, most_chosen(),
                           [&](Index count) { return is_crossed_by_choice(count); });
    }

    /// As choices have it, from that of one plan and how much it is better than a choice of as
    /// many.
    Index count_by_plans(Index by_choices) {
        const Index count = std::min(by_choices, most_chosen());
        const CountPrediction chosen = choose(count);
        const Planning quick = maker_.make_quickly(count);
        const auto planned = judge(quick);
        if (options_.stop.is_set() || !planned || !chosen.error) return by_choices;
        const double gain = planned->assured / chosen.error->assured;
        const double time = quick.plan.duration / chosen.duration;
        const Index found = least_count(count, least_, most_chosen(), [&](Index n) {
            CountPrediction at = choose(n);
            if (at.error) at.error->assured *= gain;
            return !options_.stop.is_set() && has_crossed(at.error, time * at.duration);
        });
        return options_.stop.is_set() ? by_choices : std::min(found, most_);
    }

    /// What does not keep what was asked for, made after the stop, says nothing of its number.
    void plan(Index count) {
        // What is not kept needs no bound.
        result_.planning = maker_.make(count, [&](const Planning& planning) {
            result_.error = judge(planning);
            return is_kept(planning);
        });
        const Planning& made = *result_.planning;
        const bool is_cut = options_.stop.is_set();
        if (!is_cut && !made.plan.is_stopped_early()) finished_.insert(count);
        if (is_cut && !is_kept(made)) return;
        planned_[count] = {count, true, result_.error, made.plan.duration};
    }
    /// Of the plan that result_.error is of.
    bool is_kept(const Planning& planning) const {
        return has_crossed(result_.error, planning.plan.duration) == has_limit();
    }

    /// Full plans on both sides of where it is crossed; the one that keeps what was asked for
    /// stays.
    void settle(Index count) {
        count = std::clamp(has_limit() ? count : count - 1, least_, most_);
        plan(count);
        const bool is_first_kept = is_kept(*result_.planning);
        const Index step = is_first_kept == has_limit() ? -1 : 1;
        bool is_one_kept = is_first_kept;
        for (count += step; count >= least_ && count <= most_ && !options_.stop.is_set();
             count += step) {
            const auto [error, planning] = std::pair(result_.error, result_.planning);
            plan(count);
            if (is_kept(*result_.planning) == is_first_kept) continue;
            if (is_first_kept) {
                result_.error = error;
                result_.planning = planning;
            }
            is_one_kept = true;
            break;
        }
        if (is_one_kept) mark_stop();
        conclude(is_one_kept);
    }

    /// Whether a plan of one pose less, or without a limit one more, was searched to its end.
    void mark_stop() {
        const Index next = result_.planning->search.pose_count + (has_limit() ? -1 : 1);
        result_.is_settled = next < least_ || next > most_ || finished_.contains(next);
        Plan& plan = result_.planning->plan;
        if (!result_.is_settled) plan.ending = options_.stop.ending_or(plan.ending);
    }

    void conclude(bool is_one_kept) {
        if (!is_one_kept) check_stop();
        if (!has_limit() && !is_one_kept) {
            throw InputError(fmt::format(
                "{:g} min are too short: {}, the least number of poses, take {:.10g} min",
                *target_.duration / 60, least_,
                std::ceil(result_.planning->plan.duration / 60 * 100) / 100));
        }
        result_.ending = TargetEnding::Reached;
        if (!is_one_kept) result_.ending = TargetEnding::TooManyPoses;
        if (has_limit() && is_one_kept && target_.duration &&
            result_.planning->plan.duration > *target_.duration) {
            if (!result_.is_settled) check_stop();
            result_.ending = TargetEnding::TooLong;
            const Index most = std::min(most_, choices_.candidate_count());
            least_count(least_, least_, most, [&](Index count) {
                check_stop();
                return choose(count).duration > *target_.duration;
            });
        }
        if (result_.ending == TargetEnding::Reached) return;
        result_.planning.reset();
        result_.error.reset();
    }

    /// What half, twice and four times as many poses would do, and between which numbers of them
    /// the limit would be kept if what is not known yet were known.
    void look_around() {
        if (!result_.planning) return;
        const Index count = result_.planning->search.pose_count;
        for (const Index other : {count / 2, 2 * count, 4 * count}) {
            if (options_.stop.is_set()) return;
            if (other >= least_ && other <= most_chosen()) choose(other);
        }
        if (!has_limit()) return;
        find_counts(count, std::max(least_, std::min(most_chosen(), 4 * count)));
    }

    /// Leaves nothing after a stop.
    void find_counts(Index guess, Index most) {
        CountRange range{{}, {}, most};
        if (result_.floor.lower <= *target_.limit) {
            range.lower = count_within(&ErrorRange::lower, guess, most);
        }
        if (result_.floor.upper <= *target_.limit) {
            range.upper = count_within(&ErrorRange::upper, guess, most);
        }
        if (!options_.stop.is_set()) result_.counts = range;
    }

    /// The least one of up to `most` poses, chosen or planned; nothing after a stop.
    std::optional<Index> count_within(double ErrorRange::*error, Index guess, Index most) {
        const auto is_within = [&](const std::optional<ErrorRange>& found) {
            return found && (*found).*error <= *target_.limit;
        };
        Index count = least_count(guess, least_, most, [&](Index poses) {
            return !options_.stop.is_set() && is_within(choose(poses).error);
        });
        for (const auto& [poses, prediction] : planned_) {
            if (is_within(prediction.error)) count = std::min(count, poses);
        }
        return count > most ? std::nullopt : std::optional(count);
    }

    /// Poses that reach little more than fewer: as good as those and any others.
    void fill_curve() {
        std::optional<ErrorRange> best;
        for (auto& [count, prediction] : chosen_) {
            if (best && !(prediction.error && prediction.error->assured < best->assured)) {
                prediction.error = best;
            }
            best = prediction.error;
            result_.curve.push_back(prediction);
        }
        for (const auto& [count, prediction] : planned_) result_.curve.push_back(prediction);
        std::stable_sort(result_.curve.begin(), result_.curve.end(),
                         [](const auto& a, const auto& b) { return a.pose_count < b.pose_count; });
    }

    const PlanMaker& maker_;
    const PlanningProblem& problem_;
    const PlanningOptions& options_;
    TargetPlanning& result_;
    const TargetOptions& target_;
    Index least_;
    PoolChoices choices_;
    Index most_;
    std::optional<Index> told_;  ///< the number so far
    std::map<Index, CountPrediction> chosen_;
    std::map<Index, CountPrediction> planned_;
    std::set<Index> finished_;  ///< planned, not stopped early
};

void find_floor(const PlanningProblem& problem, TargetPlanning& result) {
    const TargetOptions& target = result.target;
    const auto floor_of = [&](const Campaign& campaign) {
        return predict_range(problem.errors, campaign, {}, {}, target.quantity, target.assurance,
                             problem.request.seed.value());
    };
    result.floor = floor_of(problem.campaign);
    Campaign known = problem.campaign;
    if (problem.request.sources.estimate.empty() ||
        known.known_within.model_error == model_error_factor) {
        known.known_within.model_error = 1;
    }
    result.floor_of_known_model_error = floor_of(known).assured;
    const ErrorBudget budget = make_budget(problem.errors, problem.campaign, {}, {});
    result.left_over = budget.left_over;
    result.repeatability = budget.repeatability;
    const Chain& robot = problem.campaign.robot;
    for (Index k = 0; k < robot.parameter_count(); ++k) {
        result.has_error_terms = result.has_error_terms || robot.parameter_term(k) != nullptr;
    }
}

}  // namespace

TargetPlanning plan_for_target(const Campaign& campaign, const PlanningOptions& given,
                               const TargetOptions& target) {
    check_target(target, given);
    PlanningOptions options = given;
    options.drop_out_count = std::max<Index>(1, target.robust_to);
    PlanningProblem problem = detail::state_planning(campaign, options);
    const Index least = std::max<Index>(
        1, least_calibration_count(problem.campaign, options.stop) - problem.measured_count);
    const PlanMaker maker(std::move(problem), options);
    TargetPlanning result;
    result.target = target;
    find_floor(maker.problem(), result);
    const bool is_below_floor = target.limit && result.floor.assured > *target.limit;
    if (is_below_floor) result.ending = TargetEnding::BelowFloor;
    if (is_below_floor && result.floor.lower > *target.limit) return result;
    Search search(maker, options, result, least + target.robust_to);
    is_below_floor ? search.look_for_luck() : search.run();
    if (!result.planning) return result;
    maker.add_verification(*result.planning);
    detail::judge_left_out(*result.planning, options);
    return result;
}

}  // namespace posewise
