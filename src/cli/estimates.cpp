#include "estimates.hpp"

#include <fmt/ranges.h>

#include "common.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/estimate_file.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise::cli {

void add_force_option(CLI::App& command, bool& is_forced) {
    command.add_flag("--force", is_forced,
                     "Take an estimate that did not converge or has values no robot has");
}

std::string join_faults(const std::vector<std::string>& faults) {
    constexpr std::size_t shown = 3;
    if (faults.size() <= shown) return fmt::format("{}", fmt::join(faults, "; "));
    return fmt::format("{}; and {} more like this",
                       fmt::join(faults.begin(), faults.begin() + shown, "; "),
                       faults.size() - shown);
}

Estimate read_usable_estimate(const std::string& path, const Campaign& campaign, bool is_forced) {
    Estimate estimate = io::read_estimate(path, campaign);
    const std::vector<std::string> faults = find_faults(campaign, estimate);
    if (faults.empty()) return estimate;
    const std::string words = "is no calibration to use: " + join_faults(faults);
    if (!is_forced) throw input_error_at({path}, words + "; --force takes it all the same");
    print_warning(path + ": " + words);
    return estimate;
}

}  // namespace posewise::cli
