#pragma once

/// How the program uses threads.
namespace posewise::cli {

/// Threads that wait for work sleep instead of spinning, which on a busy machine takes the cores
/// from those that compute: unless OMP_WAIT_POLICY or GOMP_SPINCOUNT says something, the program
/// starts anew with OMP_WAIT_POLICY=passive, which OpenMP reads when it is loaded. To be called
/// first.
void wait_passively(char** argv);

/// Warns where more threads are asked for than are used.
void warn_of_many_threads();

}  // namespace posewise::cli
