#pragma once

#include <functional>
#include <string>

#include "posewise/task/study.hpp"

/// The processes that work on one study: this one alone in `posewise`, all that mpirun or srun
/// started in `posewise_mpi`. One leads: it alone prints, reads the store and writes.
namespace posewise::cli {

/// How a program ended: its exit code, and what was wrong unless it is 0. Thrown, too, where a
/// program ends because the others of its crew do; no exception, so that it reaches run_in_crew.
struct ProgramEnd {
    int code = 0;
    std::string message = {};
};

/// Prints what was wrong, if anything, in one line whatever it quotes; gives the exit code.
int report(const ProgramEnd& end);

/// Runs the program, prints what was wrong and gives the exit code. A study under a launcher of
/// several processes is run by posewise_mpi, which takes this one's place. There the others are
/// silent, and run the program only once the leader's has called the crew.
int run_in_crew(int argc, char** argv, const std::function<ProgramEnd()>& program);

/// Whether this process prints, reads the store and writes. Others reach no further than the call
/// of the crew.
bool leads_crew();

/// Who runs the trials; to be called once.
TrialCrew trial_crew();

}  // namespace posewise::cli
