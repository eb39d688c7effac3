#include "estimate_covariance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/decompositions.hpp"
#include "core/text.hpp"

namespace posewise::detail {
namespace {

/// A row up to the diagonal, of a matrix of which the rows before are there.
void read_covariance_row(const JsonValue& value, Index i, MatrixXd& matrix) {
    const std::vector<double> row = read_numbers(value, static_cast<std::size_t>(i) + 1);
    matrix.row(i).head(i + 1) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), i + 1);
    matrix.col(i).head(i + 1) = matrix.row(i).head(i + 1).transpose();
    constexpr double rounding = 1 + 1e-9;
    for (Index j = 0; j <= i; ++j) {
        if (matrix(i, j) * matrix(i, j) <= rounding * matrix(i, i) * matrix(j, j) &&
            matrix(i, i) >= 0) {
            continue;
        }
        throw value.error("is no row of a covariance; a correlation is beyond 1");
    }
}

/// Of `names`, which may be followed by others; of those only if `is_all` is false.
MatrixXd read_rows(const JsonValue& covariance, const std::vector<std::string>& names,
                   bool is_all) {
    const std::vector<JsonValue> listed = covariance["parameters"].list();
    const std::vector<JsonValue> rows = covariance["rows_si"].list();
    const bool is_short = listed.size() < names.size() || rows.size() < names.size();
    if (is_short || (is_all && (listed.size() > names.size() || rows.size() > names.size()))) {
        throw covariance.error(fmt::format("has {} parameters in {} rows, the campaign {}{}",
                                           listed.size(), rows.size(), names.size(), as_then));
    }
    MatrixXd matrix(std::ssize(names), std::ssize(names));
    for (std::size_t k = 0; k < names.size(); ++k) {
        const std::string name = listed[k].text();
        if (name != names[k]) {
            const bool is_of_base = name.starts_with("base.") || names[k].starts_with("base.");
            throw listed[k].error("is " + quote(name) + "; must be " + quote(names[k]) +
                                  (is_of_base ? as_then : ""));
        }
        read_covariance_row(rows[k], static_cast<Index>(k), matrix);
    }
    return matrix;
}

/// Parameters of the base that the estimate was made with, which come first.
std::vector<std::string> base_parameters(const JsonValue& covariance, Campaign campaign) {
    campaign.base_is_known.fill(false);
    std::vector<std::string> all = parameter_names(campaign);
    all.resize(6);
    std::vector<std::string> names;
    for (const JsonValue& listed : covariance["parameters"].list()) {
        if (std::ranges::count(all, listed.text()) == 0) break;
        names.push_back(listed.text());
    }
    return names;
}

/// Standard deviations of so many parameters from `begin` on are stated beside the covariance.
void check_sigmas(const JsonValue& root, const Campaign& campaign, Index begin, Index count,
                  const MatrixXd& covariance) {
    constexpr double rounding = 1e-9;
    const std::vector<std::string> names = parameter_names(campaign);
    const auto units = parameter_units(campaign);
    const Index robot_begin = base_parameter_count(campaign);
    const Index robot_end = robot_begin + campaign.robot.parameter_count();
    for (Index k = begin; k < begin + count; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const std::string unit = si_suffix(*units[i]);
        const JsonValue sigma = k >= robot_begin && k < robot_end
                                    ? root["robot"][names[i]]["sigma" + unit]
                                    : root["sigma"][names[i] + unit];
        const double expected = std::sqrt(covariance(k, k));
        if (std::abs(sigma.number() - expected) <= rounding * expected) continue;
        throw sigma.error(fmt::format("is {:g}, the covariance says {:g}; must agree with it",
                                      sigma.number(), expected));
    }
}

}  // namespace

std::vector<double> read_numbers(const JsonValue& value, std::size_t count) {
    const std::vector<JsonValue> items = value.list();
    if (items.size() != count) {
        throw value.error("has " + std::to_string(items.size()) + " values; must have " +
                          std::to_string(count));
    }
    std::vector<double> numbers;
    for (const JsonValue& item : items) numbers.push_back(item.number());
    return numbers;
}

MatrixXd read_covariance(const JsonValue& root, const Campaign& campaign, const EarlierUse& use) {
    const JsonValue covariance = root["covariance"];
    std::vector<std::string> names = parameter_names(campaign);
    const Index size = std::ssize(names);
    if (use.has_new_targets) {
        names.resize(names.size() - campaign.sensor->unknown_names().size());
    }
    Index begin = 0;  // of what it tells of, here and in the file
    Index begin_there = 0;
    if (use.has_new_base) {
        begin = base_parameter_count(campaign);
        const std::vector<std::string> base = base_parameters(covariance, campaign);
        begin_there = std::ssize(base);
        names.erase(names.begin(), names.begin() + begin);
        names.insert(names.begin(), base.begin(), base.end());
    }
    const Index count = std::ssize(names) - begin_there;
    const MatrixXd there = read_rows(covariance, names, !use.has_new_targets);
    MatrixXd told = MatrixXd::Zero(size, size);
    told.block(begin, begin, count, count) = there.block(begin_there, begin_there, count, count);
    check_sigmas(root, campaign, begin, count, told);
    return told;
}

void check_definite(const JsonValue& root, const MatrixXd& covariance) {
    std::vector<Index> uncertain;
    for (Index k = 0; k < covariance.rows(); ++k) {
        if (covariance(k, k) > 0) uncertain.push_back(k);
    }
    if (uncertain.empty()) return;
    const VectorXd inverse = covariance.diagonal()(uncertain).cwiseSqrt().cwiseInverse();
    const MatrixXd correlations =
        inverse.asDiagonal() * covariance(uncertain, uncertain) * inverse.asDiagonal();
    const double least =
        eigen_decomposition(correlations, Eigen::EigenvaluesOnly).eigenvalues().minCoeff();
    if (least >= -1e-9) return;
    throw root["covariance"]["rows_si"].error(
        fmt::format("is not positive definite, its correlations have the eigenvalue {:.3g}; must "
                    "be, to be a prior",
                    least));
}

}  // namespace posewise::detail
