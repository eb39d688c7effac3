#include "findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

bool agree(double a, double b) {
    return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b));
}

/// As plan files write it: "1e-05"; "null" for what is none.
std::string format_number(double value) {
    return std::isnan(value) ? "null" : fmt::format("{}", value);
}

const NamedNumber* find(const std::vector<NamedNumber>& numbers, const std::string& name) {
    const auto found = std::find_if(numbers.begin(), numbers.end(),
                                    [&](const NamedNumber& other) { return other.name == name; });
    return found == numbers.end() ? nullptr : &*found;
}

/// Names of the parameters whose scales these numbers are, in any order.
std::set<std::string> parameters_in(const std::vector<NamedNumber>& numbers) {
    std::set<std::string> names;
    for (const NamedNumber& one : numbers) {
        if (one.name.starts_with("expected_error/")) names.insert(one.name);
    }
    return names;
}

/// "sigma_m: stated 1e-05, is 5.2e-05" for each that differs.
std::vector<std::string> find_changes(const std::vector<NamedNumber>& stated,
                                      const std::vector<NamedNumber>& actual) {
    std::vector<std::string> changes;
    for (const NamedNumber& one : actual) {
        const NamedNumber* const other = find(stated, one.name);
        const double before = other != nullptr ? other->value : std::nan("");
        if (agree(one.value, before)) continue;
        changes.push_back(fmt::format("{}: stated {}, is {}", one.name, format_number(before),
                                      format_number(one.value)));
    }
    for (const NamedNumber& one : stated) {
        if (find(actual, one.name) != nullptr) continue;
        changes.push_back(
            fmt::format("{}: stated {}, is not assumed", one.name, format_number(one.value)));
    }
    return changes;
}

}  // namespace

std::vector<std::string> Verification::wrong() const {
    std::vector<std::string> names;
    for (const Finding& finding : findings) {
        const bool is_new = std::find(names.begin(), names.end(), finding.name) == names.end();
        if (!finding.is_right && is_new) names.push_back(finding.name);
    }
    return names;
}

namespace detail {

bool is_same_value(Criterion criterion, double a, double b, double tolerance) {
    const double least = criterion == Criterion::D ? 1 : 0;
    if (!std::isfinite(a) || !std::isfinite(b)) return a == b;
    return std::abs(a - b) <= tolerance * std::max({least, std::abs(a), std::abs(b)});
}

void Findings::note(const std::string& name, bool is_right, const std::string& text) {
    findings_.push_back({name, is_right, text});
}

void Findings::compare(const std::string& name, double stated, double actual, bool is_right) {
    findings_.push_back({name, is_right, "", stated, actual});
}

void Findings::compare_value(Criterion criterion, double stated, double actual, double tolerance) {
    if (std::isfinite(actual)) {
        return compare("value", stated, actual,
                       is_same_value(criterion, stated, actual, tolerance));
    }
    note("value", false,
         fmt::format("stated {}, but the poses do not identify all parameters",
                     format_number(stated)));
}

bool Findings::has_same_parameters(const Plan& plan, const Campaign& campaign) {
    const auto stated = parameters_in(plan.assumptions);
    const auto actual = parameters_in(assumptions_of(campaign));
    if (stated.empty() || stated == actual) return true;
    note(
        "parameters", false,
        fmt::format("planned for {}, the campaign has {} now, not the same ones; put back what its "
                    "keys errors, prior, planning, known and targets said, or plan again",
                    stated.size(), actual.size()));
    return false;
}

void Findings::compare_assumptions(const Plan& plan, const Campaign& campaign) {
    const auto changes = find_changes(plan.assumptions, assumptions_of(campaign));
    for (const std::string& change : changes) note("assumes", false, change);
    if (changes.empty()) note("assumes", true, "as stated, noise and scales");
}

Verification collect(Index candidate_count, const std::function<void(Findings&)>& check) {
    Findings findings;
    std::string obstacle;
    try {
        check(findings);
    } catch (const InputError& error) {
        obstacle = error.what();
    }
    return {candidate_count, findings.take(), obstacle};
}

}  // namespace detail
}  // namespace posewise
