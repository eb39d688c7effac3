#pragma once

#include "posewise/task/study.hpp"

namespace posewise::cli::mpi {

/// RunTrials of the process that leads: hands trials to the others, a few ahead so that none waits,
/// and computes some itself. Throws ProgramEnd if another process failed; after an exception of any
/// kind others may still be computing, and nothing more can be run.
void lead_trials(const ComputeTrial& compute, const std::vector<TrialId>& trials,
                 const AcceptTrial& accept, const StopSignal& stop);

}  // namespace posewise::cli::mpi
