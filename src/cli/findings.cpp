#include "findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/format.hpp"
#include "posewise/io/plan_file.hpp"

namespace posewise::cli {

void Findings::note(const std::string& name, bool is_right, const std::string& text) {
    print(fmt::format("{:<11} {}\n", name + ':', text));
    const bool is_new = std::find(wrong_.begin(), wrong_.end(), name) == wrong_.end();
    if (!is_right && is_new) wrong_.push_back(name);
}

void Findings::compare(const std::string& name, double stated, double actual, bool is_right) {
    note(name, is_right,
         is_right
             ? "as stated, " + format_short(stated, 8)
             : fmt::format("stated {}, is {}", format_short(stated, 12), format_short(actual, 12)));
}

void Findings::conclude(const std::string& path) const {
    if (wrong_.empty()) return;
    throw InputError(fmt::format("{}: not as stated: {}", path, fmt::join(wrong_, ", ")));
}

bool is_same_value(Criterion criterion, double a, double b, double tolerance) {
    const double least = is_logarithm(criterion) ? 1 : 0;
    if (!std::isfinite(a) || !std::isfinite(b)) return a == b;
    return std::abs(a - b) <= tolerance * std::max({least, std::abs(a), std::abs(b)});
}

void check_assumptions(const std::string& path, const Campaign& campaign, Findings& findings) {
    const auto changed = io::find_changed_assumptions(path, campaign);
    for (const std::string& one : changed) findings.note("assumes", false, one);
    if (changed.empty()) findings.note("assumes", true, "as stated, noise and scales");
}

}  // namespace posewise::cli
