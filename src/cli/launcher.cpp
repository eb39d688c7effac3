#include "launcher.hpp"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace posewise::cli {
namespace {

/// The variable's number; -1: not set.
int number_of(const char* variable) {
    const char* const text = std::getenv(variable);
    return text == nullptr ? -1 : std::atoi(text);
}

}  // namespace

int launched_count() {
    int count = std::max({1, number_of("OMPI_COMM_WORLD_SIZE"), number_of("PMI_SIZE")});
    // Slurm sets its own in each step; only with this one it also brings the processes together.
    if (number_of("PMIX_RANK") >= 0) count = std::max(count, number_of("SLURM_STEP_NUM_TASKS"));
    return count;
}

int launched_rank() {
    return std::max(
        {0, number_of("OMPI_COMM_WORLD_RANK"), number_of("PMI_RANK"), number_of("PMIX_RANK")});
}

bool can_share(int argc, const char* const* argv) {
    if (argc < 2 || std::string_view(argv[1]) != "study") return false;
    return std::none_of(argv, argv + argc, [](const std::string_view argument) {
        return argument == "--shard" || argument.starts_with("--shard=") ||
               argument == "--blocks" || argument.starts_with("--blocks=");
    });
}

}  // namespace posewise::cli
