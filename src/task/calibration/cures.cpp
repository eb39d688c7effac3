#include "cures.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "calibrator/robust.hpp"
#include "identify_anew.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/error_terms.hpp"
#include "task/doubt/held_out_doubt.hpp"

namespace posewise::detail {
namespace {

constexpr double beyond_chance = 2.3263;  // one-sided, 0.01 of normal deviates
/// What leaves more than this part of the error is not worth naming.
constexpr double worth_naming = 0.95;
/// What leaves over so many times the error that the best cure leaves is none.
constexpr double as_good_as = 1.5;

/// What a trial leaves of points that it judges, its configurations in their order.
struct Judged {
    RowMatrixXd squares;
    Seen is_judged;
};

/// Whether it fits the points that are no outliers of it better than the doubted one does: what
/// does not hardly predicts better.
bool fits_better(const Doubted& doubted, const CureTrial& trial, const Estimate& found) {
    constexpr double hardly = 0.97;
    const Measurements& measured = trial.measurements;
    const Seen is_judged = points_but_outliers(measured, found.outliers);
    const auto rms = [&](const Campaign& campaign, const Estimate& estimate) {
        return rms_of(squared_distances(campaign, estimate.parameters, measured), is_judged);
    };
    return rms(trial.campaign, found) <= hardly * rms(doubted.campaign, doubted.estimate);
}

std::optional<Judged> judge(const Doubted& doubted, const CureTrial& trial) {
    const Campaign& campaign = trial.campaign;
    const auto found = identify_anew(campaign, trial.measurements, trial.options);
    if (!found || (!trial.learns_sizes && !fits_better(doubted, trial, *found))) {
        return std::nullopt;
    }
    LevenbergMarquardtOptions options = trial.options;
    options.finds_model_error = false;
    const Index count = trial.measurements.configuration_count();
    const CrossValidation held_out =
        cross_validate(with_model_error(campaign, *found), trial.measurements, found->parameters,
                       std::min(doubted.held_out.folds, count), options);
    const Seen is_held_out = points_held_out(trial.measurements, held_out);
    return Judged{
        held_out.squared_distances,
        is_held_out.array() && points_but_outliers(trial.measurements, found->outliers).array()};
}

/// Which configurations of all these are.
std::vector<Index> places_of(const std::vector<std::string>& ids,
                             const std::vector<std::string>& all) {
    std::map<std::string, Index> places;
    for (const std::string& id : all) places.emplace(id, std::ssize(places));
    std::vector<Index> found;
    for (const std::string& id : ids) found.push_back(places.at(id));
    return found;
}

/// RMS of each configuration's points that were held out, the farthest; -1: none was.
Index farthest_configuration(const Doubted& doubted) {
    const Seen is_judged = points_held_out(doubted.measurements, doubted.held_out);
    Index farthest = -1;
    double largest = 0;
    for (Index i = 0; i < is_judged.rows(); ++i) {
        const auto count = static_cast<double>(is_judged.row(i).count());
        const double mean =
            is_judged.row(i).select(doubted.held_out.squared_distances.row(i).array(), 0).sum() /
            std::max(1.0, count);
        if (count == 0 || mean <= largest) continue;
        largest = mean;
        farthest = i;
    }
    return farthest;
}

/// Nothing where too little would be left.
std::optional<CureTrial> leave_out_trial(const Doubted& doubted,
                                         const std::vector<std::string>& excluded) {
    try {
        return CureTrial{exclusion(excluded), doubted.campaign,
                         leave_out(doubted.measurements, excluded), doubted.options};
    } catch (const InputError&) {
        return std::nullopt;
    }
}

bool has_terms(const Chain& robot, TermKind kind) {
    for (Index k = 0; k < robot.parameter_count(); ++k) {
        const ErrorTerm* const term = robot.parameter_term(k);
        if (term != nullptr && term->kind == kind) return true;
    }
    return false;
}

/// So many measured numbers that the prior says nothing beside them.
bool is_far_above_prior(const Doubted& doubted) {
    constexpr Index many = 30;  // a parameter
    const auto parameters = static_cast<Index>(doubted.estimate.names.size());
    return seen_row_count(*doubted.campaign.sensor, doubted.measurements.is_seen) >
           many * parameters;
}

std::vector<CureTrial> list_trials(const Doubted& doubted, const Doubts& doubts,
                                   const CureOptions& options) {
    const Campaign& campaign = doubted.campaign;
    std::vector<CureTrial> trials;
    const auto add = [&](Remedy remedy, const Campaign& other) -> CureTrial& {
        trials.push_back({std::move(remedy), other, doubted.measurements, doubted.options});
        return trials.back();
    };
    const bool has_squares = doubted.options.loss.kind == LossKind::Squares;
    if (has_squares) {
        std::vector<std::vector<std::string>> worst;
        if (doubts.scatter) worst.push_back({doubts.scatter->sample});
        if (doubts.look.outlying) {
            worst.push_back(doubts.look.outlying->ids);
        } else if (const Index farthest = farthest_configuration(doubted); farthest >= 0) {
            worst.push_back({doubted.measurements.ids[static_cast<std::size_t>(farthest)]});
        }
        for (const auto& excluded : worst) {
            if (auto trial = leave_out_trial(doubted, excluded)) {
                trials.push_back(*std::move(trial));
            }
        }
        if (!campaign.sensor->is_combined()) {
            add({"loss cauchy"}, campaign).options.loss.kind = LossKind::Cauchy;
        }
    }
    if (options.only_exclusions) return trials;
    if (options.can_learn_sizes && has_squares && campaign.spread.is_prior &&
        !campaign.sensor->has_only_pixels() && !is_far_above_prior(doubted)) {
        CureTrial& trial = add({"sizes learned"}, campaign);
        trial.learns_sizes = true;
        trial.campaign.spread.is_open = true;
    }
    for (const OtherCampaign& other : options.campaigns) add({other.key, true}, other.campaign);
    // Without a prior, or before harmonics, tilts are more than most poses tell apart.
    const Chain& robot = campaign.robot;
    if (campaign.spread.is_prior && has_terms(robot, TermKind::Harmonic) &&
        !has_terms(robot, TermKind::Tilt)) {
        add({"robot.axis_tilt: {orders: [1, 2]}", true},
            with_robot(campaign, with_axis_tilt(robot, {1, 2})));
    }
    return trials;
}

}  // namespace

std::optional<Cure> try_cure(const Doubted& doubted, const CureTrial& trial) {
    const auto judged = judge(doubted, trial);
    if (!judged) return std::nullopt;
    const std::vector<Index> places = places_of(trial.measurements.ids, doubted.measurements.ids);
    const Seen all = points_held_out(doubted.measurements, doubted.held_out);
    const Seen common = all(places, Eigen::all).array() && judged->is_judged.array();
    const RowMatrixXd before = doubted.held_out.squared_distances(places, Eigen::all);
    const VectorXd after = common.select(judged->squares, 0).rowwise().sum();
    const double deviations = rank_deviations(after, common.select(before, 0).rowwise().sum());
    if (!(deviations < -beyond_chance)) return std::nullopt;
    const Cure cure{trial.remedy, rms_of(doubted.held_out.squared_distances, all),
                    rms_of(judged->squares, judged->is_judged)};
    if (!(cure.after < worth_naming * cure.before)) return std::nullopt;
    return cure;
}

std::optional<LoneConfiguration> find_lone_configuration(const Doubted& doubted) {
    constexpr double below = 0.1;
    constexpr Index enough = 8;  // others
    if (doubted.options.loss.kind != LossKind::Squares) return std::nullopt;
    const Index farthest = farthest_configuration(doubted);
    if (farthest < 0) return std::nullopt;
    const std::string& id = doubted.measurements.ids[static_cast<std::size_t>(farthest)];
    const auto trial = leave_out_trial(doubted, {id});
    if (!trial) return std::nullopt;
    // As many numbers as unknowns fit always.
    if (trial->measurements.configuration_count() < enough) return std::nullopt;
    const auto found = identify_anew(trial->campaign, trial->measurements, trial->options);
    if (!found || 2 * found->degrees_of_freedom < doubted.estimate.degrees_of_freedom) {
        return std::nullopt;
    }
    const LoneConfiguration lone{id, doubted.estimate.fit_means.rms(), found->fit_means.rms()};
    if (!(lone.after < below * lone.before)) return std::nullopt;
    return lone;
}

Cures find_cures(const Doubted& doubted, Doubts& doubts, const CureOptions& options) {
    Cures cures;
    for (const CureTrial& trial : list_trials(doubted, doubts, options)) {
        if (doubted.options.stop.is_set()) return {};
        if (const auto cure = try_cure(doubted, trial)) {
            cures.found.push_back(*cure);
        } else {
            cures.without_effect.push_back(trial.remedy);
        }
    }
    std::ranges::stable_sort(cures.found, {}, &Cure::after);
    while (!cures.found.empty() &&
           cures.found.back().after > as_good_as * cures.found.front().after) {
        cures.without_effect.push_back(cures.found.back().remedy);
        cures.found.pop_back();
    }
    auto& outlying = doubts.look.outlying;
    if (outlying && !cures.found.empty() &&
        as_good_as * cures.found.front().after < outlying->held_out.after) {
        outlying.reset();
    }
    return cures;
}

}  // namespace posewise::detail

namespace posewise {

Remedy exclusion(const std::vector<std::string>& ids) {
    return {fmt::format("exclude {}", fmt::join(ids, ","))};
}

std::string spell(const Remedy& remedy) {
    return remedy.is_key ? remedy.words : "--" + remedy.words;
}

}  // namespace posewise
