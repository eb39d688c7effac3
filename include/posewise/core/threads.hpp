#pragma once

#include "posewise/core/types.hpp"

namespace posewise {

/// Sets the number of threads for work started by the calling thread. The default is one per core,
/// or OMP_NUM_THREADS. No result depends on it. Throws InputError for less than 1.
void set_thread_count(Index count);

/// The number of threads asked for, by set_thread_count() or OMP_NUM_THREADS.
Index asked_thread_count();

/// The number of threads used for work started by the calling thread: the number asked for, but at
/// most four per core.
Index thread_count();

/// Fixes, for the whole process, the cache sizes by which Eigen blocks its products. Otherwise
/// Eigen asks the CPU, and the order of its sums, hence the last digits of every result, depends on
/// the CPU type. The posewise program calls this first; a program that uses the library and
/// wants the same digits must do so, too. `level1` is in bytes; a value other than the default is
/// for testing that nothing depends on it.
void fix_cache_sizes(Index level1 = 32 * 1024);

}  // namespace posewise
