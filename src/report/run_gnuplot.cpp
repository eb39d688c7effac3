#include <spawn.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include "plot.hpp"
#include "posewise/core/errors.hpp"

extern char** environ;

namespace posewise::detail {
namespace {

/// The exit code of a child; -1 if it was killed by a signal.
int wait_for(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) return -1;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

void run_gnuplot(const std::string& script_path) {
    // A path that starts with "-" would be taken for an option.
    std::string script = script_path.rfind('-', 0) == 0 ? "./" + script_path : script_path;
    std::string program = "gnuplot";
    const std::array<char*, 3> arguments{program.data(), script.data(), nullptr};
    pid_t child = 0;
    const int error =
        posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments.data(), environ);
    if (error == ENOENT) throw InputError("gnuplot is not installed");
    if (error != 0) {
        throw InputError(std::string("gnuplot cannot be started: ") + std::strerror(error));
    }
    const int code = wait_for(child);
    if (code == 127) throw InputError("gnuplot is not installed");
    if (code != 0) throw InputError("gnuplot failed");
}

}  // namespace posewise::detail
