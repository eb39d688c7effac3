#include "threads.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>

#include "common.hpp"
#include "posewise/core/progress.hpp"

namespace posewise::cli {

void wait_passively(char** argv) {
    constexpr const char* policy = "OMP_WAIT_POLICY";
    if (std::getenv(policy) != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr) return;
    if (::setenv(policy, "passive", 0) == 0) ::execv("/proc/self/exe", argv);
    // Where that is not possible threads spin, and all results are the same.
}

void warn_of_many_threads() {
    const Index asked = asked_thread_count();
    const Index used = thread_count();
    if (asked <= used) return;
    print_warning(
        fmt::format("{} threads are asked for (--threads, OMP_NUM_THREADS); {} are used, "
                    "four for each core",
                    asked, used));
}

}  // namespace posewise::cli
