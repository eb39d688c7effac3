#include "loss.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace posewise {

std::string_view loss_name(LossKind kind) { return detail::name_of(detail::loss_names, kind); }

double Loss::value(double u) const {
    switch (kind) {
        case LossKind::Squares:
            break;
        case LossKind::Huber:
            if (u > width) return width * (2 * u - width);
            break;
        case LossKind::Cauchy:
            return width * width * std::log1p(u * u / (width * width));
    }
    return u * u;
}

double Loss::weight(double u) const {
    switch (kind) {
        case LossKind::Squares:
            break;
        case LossKind::Huber:
            if (u > width) return width / u;
            break;
        case LossKind::Cauchy:
            return 1 / (1 + u * u / (width * width));
    }
    return 1;
}

double Loss::influence_rate(double u) const {
    switch (kind) {
        case LossKind::Squares:
            break;
        case LossKind::Huber:
            if (u > width) return 0;
            break;
        case LossKind::Cauchy: {
            const double square = u * u / (width * width);
            return (1 - square) / ((1 + square) * (1 + square));
        }
    }
    return 1;
}

}  // namespace posewise

namespace posewise::detail {
namespace {

using ByRows = std::array<double, 6>;

double look_up(const ByRows& values, Index rows) {
    return values[static_cast<std::size_t>(std::clamp<Index>(rows, 1, 6) - 1)];
}

}  // namespace

double default_width(LossKind kind, Index rows) {
    constexpr ByRows huber{1.345, 1.5011, 1.628, 1.7311, 1.812, 1.8693};
    constexpr ByRows cauchy{2.3849, 2.5486, 2.6656, 2.7516, 2.8154, 2.8624};
    return look_up(kind == LossKind::Huber ? huber : cauchy, rows);
}

double median_length(Index rows) {
    constexpr ByRows medians{0.6745, 1.1774, 1.5382, 1.8321, 2.086, 2.3126};
    return look_up(medians, rows);
}

double outlier_length(Index rows) {
    constexpr double quantile = 4;
    const auto p = static_cast<double>(rows);
    const double root = 1 - 2 / (9 * p) + quantile * std::sqrt(2 / (9 * p));
    return std::sqrt(p * root * root * root);
}

}  // namespace posewise::detail
