// A crew at work on trials that only sleep, compute, fail or kill their process:
//
//     mpirun -n RANKS posewise_mpi_toy COUNT [WHAT [AMOUNT]]
//
// Trial i returns {i, i * i}. What each does, or what else happens:
//   sleep, work    it takes AMOUNT ms of time, of CPU time
//   large          it returns AMOUNT values, all i
//   throw          trial AMOUNT throws; throw_memory: std::bad_alloc
//   throw_early    a process that does not lead throws before any trial; throw_first: the leader
//   kill           the process of rank AMOUNT kills itself
//   accept         what trial AMOUNT returns cannot be kept
//   twice          a second list follows, half as long
//   stop           ends when AMOUNT trials are accepted, each of 1 ms
//   late           ends after AMOUNT ms, each of 20 ms
// Prints the sum of all values accepted, of how many trials, and how many processes found them.

#include <fmt/format.h>
#include <sys/types.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <map>
#include <set>
#include <stdexcept>
#include <thread>

#include "../../src/cli/crew.hpp"
#include "../../src/cli/interrupt.hpp"

namespace {

using posewise::Index;
using posewise::TrialId;
using posewise::cli::ProgramEnd;
using std::chrono::milliseconds;

struct Toy {
    Index count = 0;
    std::string what;
    int amount = 0;
};

/// CPU time of this thread alone: others of the process wait for messages.
double cpu_ms() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

int rank() {
    const char* const text = std::getenv("OMPI_COMM_WORLD_RANK");
    return text == nullptr ? 0 : std::atoi(text);
}

std::vector<double> compute(const Toy& toy, const TrialId& trial) {
    const bool is_the_one = trial.number == toy.amount;
    const auto number = static_cast<double>(trial.number);
    if (toy.what == "sleep") std::this_thread::sleep_for(milliseconds(toy.amount));
    if (toy.what == "stop") std::this_thread::sleep_for(milliseconds(1));
    if (toy.what == "late") std::this_thread::sleep_for(milliseconds(20));
    if (toy.what == "work") {
        for (const double end = cpu_ms() + toy.amount; cpu_ms() < end;) {
        }
    }
    if (toy.what == "throw" && is_the_one) throw std::runtime_error("trial fails\nin two lines");
    if (toy.what == "throw_memory" && is_the_one) throw std::bad_alloc();
    if (toy.what == "kill" && rank() == toy.amount) ::kill(::getpid(), SIGKILL);
    const auto size = static_cast<std::size_t>(toy.what == "large" ? toy.amount : 2);
    std::vector<double> values(size, number);
    values[1] = toy.what == "large" ? number : number * number;
    values.push_back(static_cast<double>(::getpid()));
    return values;
}

std::vector<TrialId> list_trials(Index first, Index last) {
    std::vector<TrialId> trials;
    for (Index i = first; i < last; ++i) trials.push_back({0, i});
    return trials;
}

void lead(const Toy& toy, const posewise::RunTrials& run) {
    const posewise::cli::InterruptFlag by_signal;
    std::atomic<bool> is_enough{false};
    std::map<Index, double> sums;
    std::set<double> processes;
    std::vector<TrialId> trials = list_trials(0, toy.count);
    const auto accept = [&](std::size_t position, const std::vector<double>& values) {
        const Index number = trials[position].number;
        if (toy.what == "accept" && number == toy.amount) throw std::runtime_error("disk is full");
        processes.insert(values.back());
        double sum = 0;
        for (std::size_t i = 0; i + 1 < values.size(); ++i) sum += values[i];
        if (!sums.emplace(number, sum).second) throw std::logic_error("twice the same trial");
        if (toy.what == "stop" && sums.size() == static_cast<std::size_t>(toy.amount)) {
            is_enough = true;
        }
    };
    posewise::StopSignal stop;
    stop.interrupted = toy.what == "stop" ? &is_enough : by_signal.get();
    if (toy.what == "late") stop.deadline = posewise::deadline_after(1e-3 * toy.amount);
    const auto begin = std::chrono::steady_clock::now();
    run(trials, accept, stop);
    if (toy.what == "twice") {
        trials = list_trials(toy.count, toy.count + toy.count / 2);
        run(trials, accept, {});
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    double total = 0;
    for (const auto& [number, sum] : sums) total += sum;
    fmt::print("{:.0f} of {} by {}\n", total, sums.size(), processes.size());
    if (std::getenv("TOY_SECONDS") != nullptr) fmt::print("{:.3f} s\n", seconds.count());
}

ProgramEnd run_toy(const Toy& toy) {
    try {
        if (toy.what == "throw_early" && !posewise::cli::leads_crew()) {
            throw std::runtime_error("no such file");
        }
        if (toy.what == "throw_first") throw std::runtime_error("no such campaign");
        posewise::cli::trial_crew()([&](const TrialId& trial) { return compute(toy, trial); },
                                    [&](const posewise::RunTrials& run) { lead(toy, run); });
    } catch (const std::bad_alloc&) {
        return {1, "out of memory"};
    } catch (const std::exception& error) {
        return {3, error.what()};
    }
    std::fflush(stdout);
    return {};
}

}  // namespace

int main(int argc, char** argv) {
    const Toy toy{argc > 1 ? std::atol(argv[1]) : 0, argc > 2 ? argv[2] : "",
                  argc > 3 ? std::atoi(argv[3]) : 0};
    return posewise::cli::run_in_crew(argc, argv, [&] { return run_toy(toy); });
}
