#include "cli/crew.hpp"

#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "cli/launcher.hpp"

namespace posewise::cli {
namespace {

/// Replaces this program by posewise_mpi, beside it or in ../libexec; returns if it is not there.
void become_one_of_many(char** argv) {
    std::error_code ignored;
    const auto folder = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
    for (const auto& program : {folder / "posewise_mpi", folder / "../libexec/posewise_mpi"}) {
        ::execv(program.c_str(), argv);
    }
}

ProgramEnd refuse_launcher() {
    if (launched_rank() != 0) return {};  // one says it
    return {1, "is started as " + std::to_string(launched_count()) +
                   " processes, but was built without MPI; start one, or shards (study --shard), "
                   "or build where Open MPI is installed"};
}

}  // namespace

int run_in_crew(int argc, char** argv, const std::function<ProgramEnd()>& program) {
    const bool is_shared = launched_count() > 1 && can_share(argc, argv);
    if (is_shared) become_one_of_many(argv);
    return report(is_shared ? refuse_launcher() : program());
}

bool leads_crew() { return true; }

TrialCrew trial_crew() { return run_on_threads; }

}  // namespace posewise::cli
