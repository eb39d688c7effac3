#include "judgement.hpp"

#include <algorithm>
#include <cmath>

#include "core/statistics.hpp"
#include "posewise/task/doubts.hpp"
#include "task/doubt/same_pose.hpp"

namespace posewise {
namespace detail {
namespace {

/// Of an RMS of so much freedom, less what was fitted; nothing if as much was fitted as they tell.
std::optional<RmsInterval> interval_of(double rms, double freedom, Index fitted_count) {
    constexpr double tail = 0.025;
    const double left = freedom - static_cast<double>(fitted_count);
    if (left <= 0) return std::nullopt;
    const auto end = [&](double p) {
        return rms * std::sqrt(freedom / chi_squared_quantile(p, left));
    };
    return RmsInterval{end(1 - tail), end(tail), left};
}

bool is_repeated(const Judge& judge, const VectorXd& q) {
    const RowMatrixXd& known = judge.calibrated_with;
    for (Index i = 0; i < known.rows(); ++i) {
        if (is_same_pose(known.row(i).transpose(), q)) return true;
    }
    return false;
}

PoseGroup group_of(const Judge& judge, const RowMatrixXd& configuration) {
    if (is_repeated(judge, configuration.row(0).transpose())) return PoseGroup::Repeated;
    return find_beyond_measured(judge.campaign, judge.calibrated_with, configuration)
               ? PoseGroup::Beyond
               : PoseGroup::New;
}

/// How sure figures of these poses are; where the estimate does not tell, a configuration counts as
/// one target.
ErrorFreedom freedom_of(const Judge& judge, const Measurements& others) {
    if (judge.knows_expected) return error_freedom(judge.campaign, judge.estimate, others);
    const Sensor& sensor = *judge.campaign.sensor;
    const Index numbers =
        sensor.has_lengths() ? sensor.lengths_per_target() : sensor.rows_per_target();
    const auto freedom = static_cast<double>(numbers * others.configuration_count());
    return {freedom, freedom};
}

/// The factor that found and expected may differ by.
double chance_of(const Judge& judge, double degrees_of_freedom) {
    constexpr double deviations = 2;
    constexpr double tolerated = 1.25;
    const Estimate& estimate = judge.estimate;
    const double left = std::max<double>(1, static_cast<double>(estimate.degrees_of_freedom));
    const double within = judge.campaign.spread.is_prior ? std::log(estimate.model_error_within)
                                                         : std::sqrt(0.5 / left);
    const double of_poses = std::sqrt(0.5 / degrees_of_freedom);
    return std::max(tolerated, std::exp(deviations * std::hypot(within, of_poses)));
}

ChanceVerdict verdict_of(const JudgedGroup& group) {
    if (!group.expected) return ChanceVerdict::NotJudged;
    if (!(group.ratio() <= group.chance)) return ChanceVerdict::Beyond;
    if (group.group == PoseGroup::Repeated) return ChanceVerdict::NotJudged;
    return group.ratio() * group.chance >= 1 ? ChanceVerdict::Within : ChanceVerdict::Below;
}

/// Whether some target was seen there.
bool shows_any(const Measurements& others, const std::vector<Index>& members) {
    return times_seen(others)(members, Eigen::all).sum() > 0;
}

/// The configuration that has more than half of the sum of squares, if there are three at least.
std::optional<WorstConfiguration> worst_of(const Judge& judge, const Measurements& part) {
    constexpr Index least = 3;
    const Index count = part.configuration_count();
    if (count < least) return std::nullopt;
    const VectorXd squares =
        squared_distances(judge.campaign, judge.estimate.parameters, part).rowwise().sum();
    Index worst = 0;
    if (!(2 * squares.maxCoeff(&worst) > squares.sum())) return std::nullopt;
    const Measurements others = take(part, all_but(count, {worst}));
    return WorstConfiguration{
        part.ids[static_cast<std::size_t>(worst)],
        make_metrics(judge.campaign, judge.estimate.parameters, others).rms()};
}

JudgedGroup judge_group(const Judge& judge, PoseGroup group, const std::vector<Index>& members,
                        const Measurements& others) {
    const Measurements part = take(others, members);
    JudgedGroup judged;
    judged.group = group;
    judged.configurations = members;
    judged.found = make_metrics(judge.campaign, judge.estimate.parameters, part);
    if (group == PoseGroup::Beyond) {
        judged.joints =
            find_beyond_measured(judge.campaign, judge.calibrated_with, part.configurations)
                ->joints;
    }
    if (const NominalRobot* const nominal = judge.nominal) {
        judged.nominal = make_metrics(nominal->campaign, nominal->parameters(), part).rms();
    }
    const ErrorFreedom freedom = freedom_of(judge, part);
    judged.interval = interval_of(judged.found.rms(), freedom.of_poses, judge.fitted_count);
    if (!judge.knows_expected) return judged;
    judged.expected = expected_sample_error(judge.campaign, judge.estimate, part);
    judged.chance = chance_of(judge, freedom.of_robots);
    judged.verdict = verdict_of(judged);
    if (judged.verdict == ChanceVerdict::Beyond) judged.worst = worst_of(judge, part);
    return judged;
}

}  // namespace

Judgement judge(const Judge& judge, const Measurements& others) {
    Judgement judgement;
    judgement.found = make_metrics(judge.campaign, judge.estimate.parameters, others);
    judgement.units = &judge.campaign.sensor->main_units();
    if (judge.knows_expected) {
        judgement.expected = expected_sample_error(judge.campaign, judge.estimate, others);
    }
    for (const PoseGroup group : {PoseGroup::New, PoseGroup::Beyond, PoseGroup::Repeated}) {
        std::vector<Index> members;
        for (Index i = 0; i < others.configuration_count(); ++i) {
            if (group_of(judge, others.configurations.row(i)) == group) members.push_back(i);
        }
        if (!shows_any(others, members)) continue;
        judgement.groups.push_back(judge_group(judge, group, members, others));
    }
    return judgement;
}

}  // namespace detail

namespace {

LimitVerdict compare(const RmsInterval& interval, double limit) {
    if (interval.upper <= limit) return LimitVerdict::Kept;
    return interval.lower > limit ? LimitVerdict::NotKept : LimitVerdict::Open;
}

}  // namespace

std::optional<LimitVerdict> judge_limit(const JudgedGroup& group, double limit) {
    if (group.group == PoseGroup::Repeated || !group.interval) return std::nullopt;
    return compare(*group.interval, limit);
}

std::optional<Index> poses_to_decide(const JudgedGroup& group, double limit) {
    constexpr Index most = 1000;
    const Index count = std::ssize(group.configurations);
    const double freedom = group.interval.value().degrees_of_freedom / static_cast<double>(count);
    for (Index more = count + 1; more <= most; ++more) {
        const auto interval =
            detail::interval_of(group.found.rms(), freedom * static_cast<double>(more), 0);
        if (compare(*interval, limit) != LimitVerdict::Open) return more;
    }
    return std::nullopt;
}

}  // namespace posewise
