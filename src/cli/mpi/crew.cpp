#include "cli/crew.hpp"

#include <mpi.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <stdexcept>
#include <utility>

#include "cli/launcher.hpp"
#include "leader.hpp"
#include "messages.hpp"
#include "posewise/core/progress.hpp"

namespace posewise::cli {
namespace {

using namespace mpi;

/// Computes what the leader hands out, in its order, until there will be no more.
void follow_leader(const ComputeTrial& compute) {
    std::deque<Job> jobs;
    while (true) {
        const std::optional<Message> message = jobs.empty() ? receive() : receive_if_any();
        if (!message) {
            const Job job = jobs.front();
            jobs.pop_front();
            send(leader, Tag::Result,
                 to_bytes<std::size_t>({job.position}) + to_bytes(compute(job.trial)));
        } else if (message->tag == Tag::Work) {
            for (const Job& job : from_bytes<Job>(message->bytes)) jobs.push_back(job);
        } else if (message->tag == Tag::Drop) {
            send(leader, Tag::Dropped, to_bytes<std::size_t>({jobs.size()}));
            jobs.clear();
        } else if (message->tag == Tag::End) {
            return;
        }
    }
}

std::string name_of_this() {
    char host[MPI_MAX_PROCESSOR_NAME] = "";
    int length = 0;
    MPI_Get_processor_name(host, &length);
    return "rank " + std::to_string(own_rank()) + " on " + host;
}

/// The program in a process that does not lead.
void follow(const std::function<ProgramEnd()>& program) {
    if (receive().tag == Tag::Begin) {
        try {
            const auto [code, message] = program();
            send(leader, Tag::Failure, to_bytes<int>({code}) + name_of_this() + ": " + message);
            while (receive().tag != Tag::End) {
            }
        } catch (const ProgramEnd&) {  // by the leader's wish
        }
    }
    send(leader, Tag::Bye);
}

/// Lets the others go, each when it has computed the trial it is at.
void dismiss() {
    for (int rank = 1; rank < process_count(); ++rank) send(rank, Tag::End);
    for (int left = process_count() - 1; left > 0;) {
        if (receive().tag == Tag::Bye) --left;
    }
}

ProgramEnd lead(const std::function<ProgramEnd()>& program) {
    if (process_count() == 1 && launched_count() > 1) {
        if (launched_rank() != 0) return {};  // one says it
        return {1, "its launcher started " + std::to_string(launched_count()) +
                       " processes, but not by the MPI that posewise was built with; use that "
                       "one's mpirun"};
    }
    try {
        return program();
    } catch (const ProgramEnd& failure) {
        return failure;
    }
}

void be_silent() {
    for (std::FILE* const stream : {stdout, stderr}) {
        if (std::freopen("/dev/null", "w", stream) == nullptr) std::abort();
    }
}

/// mpirun passes the wish to end on as SIGTERM, to all; the leader ends the others.
void leave_signals_to_leader() {
    if (leads_crew()) return;
    std::signal(SIGTERM, SIG_IGN);
    std::signal(SIGINT, SIG_IGN);
}

}  // namespace

int run_in_crew(int argc, char** argv, const std::function<ProgramEnd()>& program) {
    int provided = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
    if (process_count() > 1) {
        set_thread_count(1);  // unless the program says otherwise
        leave_signals_to_leader();
    }
    int code = 0;
    if (leads_crew()) {
        code = report(lead(program));
        dismiss();
    } else {
        be_silent();
        follow(program);
    }
    MPI_Finalize();
    return code;
}

bool leads_crew() { return own_rank() == leader; }

TrialCrew trial_crew() {
    if (process_count() == 1) return run_on_threads;
    if (!leads_crew()) {
        return [](const ComputeTrial& compute, const auto& /*lead*/) {
            follow_leader(compute);
            throw ProgramEnd{};
        };
    }
    return [](const ComputeTrial& compute, const std::function<void(const RunTrials&)>& lead) {
        for (int rank = 1; rank < process_count(); ++rank) send(rank, Tag::Begin);
        bool is_usable = true;
        lead([&](const std::vector<TrialId>& trials, const AcceptTrial& accept,
                 const StopSignal& stop) {
            if (!std::exchange(is_usable, false)) {
                throw std::logic_error("trials shall run after some that failed");
            }
            lead_trials(compute, trials, accept, stop);
            is_usable = true;
        });
    };
}

}  // namespace posewise::cli
