#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <thread>

#include "plot.hpp"
#include "posewise/core/errors.hpp"

extern char** environ;

namespace posewise::detail {
namespace {

/// Waits until a child has ended; false if it has not by then, or shall not go on.
bool wait_for(pid_t child, int& status, const std::function<bool()>& is_stopped,
              std::chrono::milliseconds limit) {
    constexpr std::chrono::milliseconds pause{5};
    const auto deadline = std::chrono::steady_clock::now() + limit;
    for (;;) {
        const pid_t ended = waitpid(child, &status, WNOHANG);
        if (ended == child || (ended < 0 && errno != EINTR)) return true;
        const bool is_late = std::chrono::steady_clock::now() > deadline;
        if (is_late || (is_stopped && is_stopped())) return false;
        std::this_thread::sleep_for(pause);
    }
}

void end(pid_t child) {
    int status = 0;
    ::kill(child, SIGKILL);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
}

}  // namespace

void run_gnuplot(const std::string& script_path, const std::function<bool()>& is_stopped,
                 std::chrono::milliseconds limit) {
    // A path that starts with "-" would be taken for an option.
    std::string script = script_path.rfind('-', 0) == 0 ? "./" + script_path : script_path;
    std::string program = "gnuplot";
    const std::array<char*, 3> arguments{program.data(), script.data(), nullptr};
    pid_t child = 0;
    posix_spawn_file_actions_t files;  // what it prints is no result of ours
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, STDERR_FILENO, STDOUT_FILENO);
    const int error =
        posix_spawnp(&child, program.c_str(), &files, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (error == ENOENT) throw InputError("gnuplot is not installed");
    if (error != 0) {
        throw InputError(std::string("gnuplot cannot be started: ") + std::strerror(error));
    }
    int status = 0;
    if (!wait_for(child, status, is_stopped, limit)) {
        end(child);
        throw InputError("gnuplot did not end by itself and was ended");
    }
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;  // -1: by a signal
    if (code == 127) throw InputError("gnuplot is not installed");
    if (code != 0) throw InputError("gnuplot failed");
}

}  // namespace posewise::detail
