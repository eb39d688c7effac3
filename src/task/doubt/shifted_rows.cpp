#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise {
namespace {

/// Measurements of configurations first to last - 1, their joint values from `shift` rows before.
Measurements shifted(const Measurements& measured, Index first, Index last, Index shift) {
    std::vector<Index> rows;
    for (Index i = first; i < last; ++i) {
        if (i - shift >= 0 && i - shift < measured.configuration_count()) rows.push_back(i);
    }
    Measurements part = take(measured, rows);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        part.configurations.row(static_cast<Index>(k)) =
            measured.configurations.row(rows[k] - shift);
    }
    return part;
}

/// By how much each configuration is missed, its joint values from `shift` rows before; infinite
/// where there are none.
VectorXd distances(const Campaign& campaign, const Parameters& parameters,
                   const Measurements& measured, Index shift) {
    const Index count = measured.configuration_count();
    const RowMatrixXd squares =
        squared_distances(campaign, parameters, shifted(measured, 0, count, shift));
    const VectorXd seen = times_seen(measured).cwiseMin(1).rowwise().sum();
    VectorXd all = VectorXd::Constant(count, std::numeric_limits<double>::infinity());
    all.segment(std::max<Index>(shift, 0), squares.rows()) = squares.rowwise().sum();
    return all.cwiseQuotient(seen.cwiseMax(1)).cwiseSqrt();
}

double median(const VectorXd& values) {
    return detail::quantile(values, 0.5, detail::QuantileRule::Upper);
}

/// Where the shifted rows begin: the split with the least sum of logarithms.
Index best_split(const VectorXd& right, const VectorXd& wrong_row) {
    const double least = 1e-3 * std::min(right.minCoeff(), wrong_row.minCoeff()) + 1e-12;
    const auto cost = [&](double distance) {
        return std::isfinite(distance) ? std::log(distance + least) : 10.0;
    };
    double sum = 0;
    for (const double distance : right) sum += cost(distance);
    double best = sum;
    Index split = right.size();
    for (Index i = right.size() - 1; i >= 0; --i) {
        sum += cost(wrong_row[i]) - cost(right[i]);
        if (sum < best) {
            best = sum;
            split = i;
        }
    }
    return split;
}

}  // namespace

std::optional<ShiftedRows> find_shifted_rows(const Campaign& campaign,
                                             const Measurements& measured) {
    constexpr double plain = 0.2;
    const Index count = measured.configuration_count();
    const Registration as_read = register_base_and_targets(campaign, measured);
    if (!as_read.is_determined() || campaign.sensor->has_contacts()) return std::nullopt;
    const double before = median(distances(campaign, as_read.parameters, measured, 0));
    std::optional<ShiftedRows> best;
    for (const Index shift : {1, -1}) {
        for (const Index part : {count / 4, count / 3, count / 2, count}) {
            // Base and targets by the first rows as read, or by the last ones shifted.
            for (const bool by_last : {false, true}) {
                const Registration start = register_base_and_targets(
                    campaign, by_last ? shifted(measured, count - part, count, shift)
                                      : shifted(measured, 0, part, 0));
                if (!start.is_determined()) continue;
                const VectorXd right = distances(campaign, start.parameters, measured, 0);
                const VectorXd other = distances(campaign, start.parameters, measured, shift);
                const Index split = best_split(right, other);
                if (split > count - 3) continue;
                VectorXd set_right = right;
                set_right.tail(count - split) = other.tail(count - split);
                const double after = median(set_right);
                if (after > plain * before || (best && after >= best->after)) continue;
                best = ShiftedRows{measured.ids[static_cast<std::size_t>(split)], shift, before,
                                   after};
            }
        }
    }
    return best;
}

}  // namespace posewise
