#include <algorithm>
#include <cmath>

#include "residual_patterns.hpp"

namespace posewise::detail {
namespace {

/// Configurations: more than the columns of a translation, since their scatter is what it is judged
/// by; as many more than those of a whole motion.
constexpr Index least_on_a_side = 5;
constexpr Index least_to_turn = 8;
constexpr std::size_t most_changes = 3;

/// A part of the set-up that may have moved: its columns, and where it matters.
struct Part {
    std::string name;
    RowMatrixXd X;               ///< translations first, three; then rotations, if there are some
    std::vector<Index> members;  ///< configurations that see it
    ScaleFrom scale_from = ScaleFrom::Score;
};

Part part_of_target(const Fitted& fitted, const PatternColumns& columns, Index target) {
    const Sensor& sensor = *fitted.campaign.sensor;
    const bool is_body = sensor.has_orientation();
    std::vector<Index> which;
    for (Index axis = 0; axis < 3; ++axis) {
        const Index k = sensor.targets().unknown_index(target, axis);
        if (k >= 0) which.push_back(k);
    }
    if (which.size() < 3) return {};
    if (is_body) which = {0, 1, 2, 3, 4, 5};
    Part part{
        is_body ? "tool" : "target" + std::to_string(target + 1), columns.unknowns(which), {}};
    for (Index i = 0; i < fitted.measured.configuration_count(); ++i) part.members.push_back(i);
    return part;
}

/// Readings of one target, or of one socket that the ball touches, along the instrument's axes.
Part part_of_readings(const Sensor& sensor, const PatternColumns& columns, const LinearFit& fit,
                      const RowMatrixXd& seen, Index target) {
    const RowMatrixXd shift = columns.shift();
    Part part{"", RowMatrixXd::Zero(shift.rows(), shift.cols()), {}};
    for (Index i = 0; i < fit.count(); ++i) {
        if (seen(i, target) == 0) continue;
        part.members.push_back(i);
        Index row = fit.begin(i);
        for (Index j = 0; j < target; ++j) row += seen(i, j) > 0 ? sensor.rows_of(j) : 0;
        const Index width = sensor.rows_of(target);
        part.X.middleRows(row, width) = shift.middleRows(row, width);
    }
    return part;
}

std::vector<Part> list_parts(const Fitted& fitted, const PatternColumns& columns,
                             const LinearFit& fit) {
    const Sensor& sensor = *fitted.campaign.sensor;
    std::vector<Part> parts{{"base", columns.base(), all_but(fit.count(), {})}};
    for (Index target = 0; target < sensor.targets().count(); ++target) {
        Part part = part_of_target(fitted, columns, target);
        if (part.X.cols() > 0) parts.push_back(std::move(part));
    }
    // A shift is one of the world's axes, which only the first of several instruments has.
    const bool has_shifts = columns.shift().cols() > 0 && !sensor.is_combined();
    if (!has_shifts || sensor.target_count() == 1) return parts;
    const std::vector<std::string> contacts = sensor.contact_names();
    const RowMatrixXd seen = times_seen(fitted.measured);
    for (Index k = 0; k < sensor.target_count(); ++k) {
        Part part = part_of_readings(sensor, columns, fit, seen, k);
        part.name = "readings of target" + std::to_string(k + 1);
        if (sensor.has_contacts()) {
            part.name = "socket " + contacts[static_cast<std::size_t>(k)];
            part.X *= -1;  // readings are ball less socket
            part.scale_from = ScaleFrom::AllResiduals;
        }
        parts.push_back(std::move(part));
    }
    return parts;
}

/// A change of one part, as a step or a drift.
struct Candidate {
    const Part* part = nullptr;
    /// The fit that it is judged beside: with the part being elsewhere all the time, which a model
    /// where it is known does not have.
    LinearFit without;
    Index first = 0;  ///< among the part's members; 0: it drifts
    RowMatrixXd X;
    Score score;
};

RowMatrixXd ramp(const LinearFit& fit, const Part& part) {
    RowMatrixXd X = RowMatrixXd::Zero(part.X.rows(), part.X.cols());
    const auto last = static_cast<double>(std::ssize(part.members) - 1);
    for (Index k = 0; k < std::ssize(part.members); ++k) {
        const Index i = part.members[static_cast<std::size_t>(k)];
        X.middleRows(fit.begin(i), fit.rows(i)) =
            static_cast<double>(k) / last * part.X.middleRows(fit.begin(i), fit.rows(i));
    }
    return X;
}

/// Translation alone, if the rotation is within chance or too few configurations tell of it.
Candidate judge(const LinearFit& fit, const Part& part, Index first, RowMatrixXd X) {
    Candidate candidate{&part, fit, first, std::move(X), {}};
    const auto translate = [&] {
        candidate.X = RowMatrixXd(candidate.X.leftCols(3));
        candidate.score = score(fit, candidate.X, 1, part.scale_from);
        return candidate;
    };
    const Index after = std::ssize(part.members) - first;
    if (std::min(first == 0 ? after : first, after) < least_to_turn) return translate();
    candidate.score = score(fit, candidate.X, 1, part.scale_from);
    if (candidate.X.cols() == 3) return candidate;
    const Score translation = score(fit, candidate.X.leftCols(3));
    const RowMatrixXd rotations = candidate.X.rightCols(candidate.X.cols() - 3);
    return score(translation.with, rotations).is_beyond(0.01) ? candidate : translate();
}

/// How much of what configurations are missed by, held out, stays with the change.
double share_left(const Candidate& candidate, const std::vector<Index>& configurations) {
    return held_out_squares(candidate.score.with, configurations) /
           held_out_squares(candidate.without, configurations);
}

std::optional<Candidate> find_likeliest(const LinearFit& fit, const std::vector<Part>& parts) {
    double tried = 0;
    for (const Part& part : parts) tried += static_cast<double>(part.members.size());
    std::optional<Candidate> best;
    double least_share = material;
    const auto take = [&](Candidate candidate) {
        if (!candidate.score.is_beyond(chance_of_change / tried)) return;
        const double share = share_left(candidate, candidate.part->members);
        if (share > least_share) return;
        least_share = share;
        best = std::move(candidate);
    };
    for (const Part& part : parts) {
        if (std::ssize(part.members) < 2 * least_on_a_side) continue;
        const LinearFit without = score(fit, part.X).with;
        const ChangePoint point = find_change_point(without, part.X, part.members, least_on_a_side);
        if (point.statistic > 0) {
            take(judge(without, part, point.first,
                       from_member(without, part.X, part.members, point.first)));
        }
        take(judge(without, part, 0, ramp(without, part)));
    }
    return best;
}

/// "21-40", or "21" where it is one.
std::string range_of(const std::vector<std::string>& ids, Index first, Index last) {
    const std::string& from = ids[static_cast<std::size_t>(first)];
    return first == last ? from : from + "-" + ids[static_cast<std::size_t>(last)];
}

/// Without the fewer configurations; else with the change as one more unknown. `before`: with the
/// changes found so far as unknowns, m or rad.
void try_cure(const Fitted& fitted, const LinearFit& fit, double before, const Candidate& candidate,
              SetUpChange& change) {
    change.held_out = {before, before * std::sqrt(share_left(candidate, all_but(fit.count(), {})))};
    if (change.is_gradual || std::ssize(candidate.part->members) < fit.count()) return;
    const bool is_later_smaller = 2 * candidate.first >= fit.count();
    const Index first = is_later_smaller ? candidate.first : 0;
    const Index last = is_later_smaller ? fit.count() - 1 : candidate.first - 1;
    std::vector<Index> out;
    for (Index i = first; i <= last; ++i) out.push_back(i);
    const auto without = fit_again(
        fitted.campaign, take(fitted.measured, all_but(fit.count(), out)), fitted.estimate.loss);
    if (!without) return;
    const double after = held_out_rms(*without);
    if (after * after > material * before * before) return;
    change.excluded = range_of(fitted.measured.ids, first, last);
    change.held_out.after = after;
}

SetUpChange describe(const Fitted& fitted, const LinearFit& fit, double before,
                     const Candidate& candidate) {
    const std::vector<Index>& members = candidate.part->members;
    const auto id = [&](Index k) {
        return fitted.measured.ids[static_cast<std::size_t>(members[static_cast<std::size_t>(k)])];
    };
    SetUpChange change;
    change.part = candidate.part->name;
    change.is_gradual = candidate.first == 0;
    change.last_before = id(change.is_gradual ? 0 : candidate.first - 1);
    change.first_after = id(change.is_gradual ? std::ssize(members) - 1 : candidate.first);
    change.translation = candidate.score.effect.head<3>();
    if (candidate.score.effect.size() > 3) change.rotation = candidate.score.effect.tail<3>();
    try_cure(fitted, fit, before, candidate, change);
    return change;
}

}  // namespace

std::vector<SetUpChange> find_set_up_changes(const Fitted& fitted, const PatternColumns& columns,
                                             LinearFit& fit) {
    const std::vector<Part> parts = list_parts(fitted, columns, fit);
    const std::vector<Index> all = all_but(fit.count(), {});
    const double at_first = held_out_rms(fitted) / std::sqrt(held_out_squares(fit, all));
    std::vector<SetUpChange> changes;
    while (changes.size() < most_changes) {
        const auto found = find_likeliest(fit, parts);
        if (!found) break;
        const double before = at_first * std::sqrt(held_out_squares(fit, all));
        changes.push_back(describe(fitted, fit, before, *found));
        fit = found->score.with;
    }
    return changes;
}

}  // namespace posewise::detail
