#pragma once

/// What the environment says of mpirun, mpiexec or srun.
namespace posewise::cli {

/// How many processes were started together to speak by MPI; 1 without a launcher.
int launched_count();
/// Which of them this is, from 0.
int launched_rank();
/// Whether the command line asks for what several processes can share: a study, unless it is one
/// shard, which depends on nothing else.
bool can_share(int argc, const char* const* argv);

}  // namespace posewise::cli
