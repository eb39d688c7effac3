#include <algorithm>
#include <cmath>

#include "core/statistics.hpp"
#include "posewise/task/doubts.hpp"
#include "residual_patterns.hpp"

namespace posewise {
namespace {

using detail::Fitted;
using detail::FittedProblem;
using detail::LinearFit;

constexpr Index least_configurations = 8;
constexpr std::size_t most_outlying = 10;

/// Sums of squares that fall without each configuration, per row: about a scale times chi squared
/// of unknown degrees of freedom (rows of one configuration depend on each other), both found from
/// the quartiles. The largest that n of them exceed with this chance.
double largest_by_chance(const VectorXd& falls, double chance) {
    const auto quartile = [&](double p) {
        return detail::quantile(falls, p, detail::QuantileRule::Linear);
    };
    const double ratio = quartile(0.75) / quartile(0.25);
    double freedom = 1;
    for (const double more : {1.5, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0}) {
        if (detail::chi_squared_quantile(0.75, more) <
            ratio * detail::chi_squared_quantile(0.25, more)) {
            break;
        }
        freedom = more;
    }
    const double mean = quartile(0.5) * freedom / detail::chi_squared_quantile(0.5, freedom);
    const auto count = static_cast<double>(falls.size());
    constexpr double efficiency = 0.37;  // of a median [Rousseeuw & Croux 1993]
    return detail::mixture_quantile(1 - chance / count, {{mean, freedom}},
                                    efficiency * freedom * count);
}

/// The configuration that the others contradict most, if beyond chance.
std::optional<Index> find_worst(const Fitted& fitted) {
    const FittedProblem linearised(fitted);
    const auto fit = linear_fit(linearised.problem, fitted.estimate.parameters);
    if (!fit || fit->count() < least_configurations) return std::nullopt;
    VectorXd falls(fit->count());
    for (Index i = 0; i < fit->count(); ++i) {
        falls[i] =
            leave_out(*fit, i).squares / static_cast<double>(std::max<Index>(1, fit->rows(i)));
    }
    Index worst = 0;
    const double largest = falls.maxCoeff(&worst);
    if (largest <= largest_by_chance(falls, detail::chance_of_outlying)) return std::nullopt;
    return worst;
}

/// Two that fit with each other's joint values, where neither does with its own.
std::optional<std::pair<std::string, std::string>> find_exchanged(
    const Fitted& others, const Measurements& measured, const std::vector<Index>& outlying) {
    constexpr double fits = 5;  // times what the others are missed by
    for (const Index first : outlying) {
        for (const Index second : outlying) {
            if (first >= second) continue;
            Measurements pair = take(measured, {first, second});
            pair.configurations.row(0).swap(pair.configurations.row(1));
            const double rms =
                make_metrics(others.campaign, others.estimate.parameters, pair).rms();
            if (rms < fits * others.estimate.fit.rms()) return {{pair.ids[0], pair.ids[1]}};
        }
    }
    return std::nullopt;
}

/// Takes the outlying configurations out of `fitted`, one after another.
std::optional<OutlyingConfigurations> take_out_outlying(std::optional<Fitted>& fitted) {
    const Measurements all = fitted->measured;
    OutlyingConfigurations outlying;
    outlying.held_out.before = detail::held_out_rms(*fitted);
    const double squares_before = fitted->estimate.fit.rms();
    std::vector<Index> out;
    while (out.size() < most_outlying) {
        const auto worst = find_worst(*fitted);
        if (!worst) break;
        const std::string id = fitted->measured.ids[static_cast<std::size_t>(*worst)];
        const Measurements rest =
            take(fitted->measured, all_but(fitted->measured.configuration_count(), {*worst}));
        auto again = detail::fit_again(fitted->campaign, rest, fitted->estimate.loss);
        if (!again) break;
        outlying.ids.push_back(id);
        out.push_back(std::ranges::find(all.ids, id) - all.ids.begin());
        fitted.emplace(std::move(*again));
    }
    if (out.empty()) return std::nullopt;
    const double left = fitted->estimate.fit.rms() / squares_before;
    outlying.squares_left = left * left;
    outlying.held_out.after = detail::held_out_rms(*fitted);
    if (outlying.held_out.after * outlying.held_out.after >
        detail::material * outlying.held_out.before * outlying.held_out.before) {
        return std::nullopt;
    }
    outlying.exchanged = find_exchanged(*fitted, all, out);
    return outlying;
}

void look_for_patterns(const Fitted& fitted, ResidualLook& look) {
    const FittedProblem linearised(fitted);
    const Parameters& at = fitted.estimate.parameters;
    auto fit = linear_fit(linearised.problem, at);
    if (!fit) return;
    const detail::PatternColumns columns(linearised, at);
    look.changes = find_set_up_changes(fitted, columns, *fit);
    look.joints = find_joint_patterns(fitted, columns, *fit);
    // A moved instrument, or a rail that is read wrong, is a factor in part.
    if (!look.changes.empty() || !look.joints.empty()) return;
    const auto by_sizes = linear_fit(linearised.problem, at, detail::FitPrior::ExpectedSizes);
    if (by_sizes) look.lengths = find_length_factor(fitted, columns, *by_sizes);
}

}  // namespace

bool ResidualLook::is_empty() const {
    return !outlying && changes.empty() && !(lengths && lengths->errors) && joints.empty() &&
           !rounded && !rounded_readings && !shifted;
}

ResidualLook look_at_residuals(const Campaign& campaign, const Measurements& measurements,
                               const Estimate& estimate) {
    constexpr double rounding = 1e-9;  // m or rad; below it residuals have no pattern of interest
    ResidualLook look;
    if (!estimate.undetermined.empty() || estimate.fit.rms() < rounding ||
        measurements.configuration_count() < least_configurations) {
        return look;
    }
    std::optional<Fitted> fitted(Fitted{campaign, measurements, estimate});
    look.rounded = detail::find_rounded_joints(*fitted);
    look.rounded_readings = detail::find_rounded_readings(*fitted);
    if (estimate.loss.kind == LossKind::Squares) look.outlying = take_out_outlying(fitted);
    look_for_patterns(*fitted, look);
    return look;
}

std::optional<OutlyingConfigurations> find_gross_configurations(const Campaign& campaign,
                                                                const Measurements& measurements,
                                                                const Estimate& estimate) {
    constexpr double below = 0.1;
    if (estimate.loss.kind != LossKind::Squares || !estimate.undetermined.empty()) {
        return std::nullopt;
    }
    Loss robust;
    robust.kind = LossKind::Cauchy;
    const auto bent_less = detail::fit_again(campaign, measurements, robust);
    if (!bent_less) return std::nullopt;
    std::vector<Index> out;
    for (const Outlier& outlier : bent_less->estimate.outliers) {
        if (std::ranges::find(out, outlier.configuration) == out.end()) {
            out.push_back(outlier.configuration);
        }
    }
    const Index count = measurements.configuration_count();
    const auto most = std::min(static_cast<Index>(most_outlying), count / 5);
    if (out.empty() || std::ssize(out) > most || count - std::ssize(out) < least_configurations) {
        return std::nullopt;
    }
    const auto rest =
        detail::fit_again(campaign, take(measurements, all_but(count, out)), estimate.loss);
    if (!rest || rest->estimate.fit.rms() > below * estimate.fit.rms()) return std::nullopt;
    OutlyingConfigurations outlying;
    for (const Index i : out) {
        outlying.ids.push_back(measurements.ids[static_cast<std::size_t>(i)]);
    }
    const double left = rest->estimate.fit.rms() / estimate.fit.rms();
    outlying.squares_left = left * left;
    outlying.held_out = {detail::held_out_rms({campaign, measurements, estimate}),
                         detail::held_out_rms(*rest)};
    outlying.exchanged = find_exchanged(*rest, measurements, out);
    return outlying;
}

}  // namespace posewise
