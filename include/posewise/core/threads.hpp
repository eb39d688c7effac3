#pragma once

#include "posewise/core/types.hpp"

namespace posewise {

/// Sets the number of threads for work started by the calling thread; by default one a core, or as
/// OMP_NUM_THREADS says. No result depends on it. Throws InputError for less than 1.
void set_thread_count(Index count);

/// The number asked for, by set_thread_count() or OMP_NUM_THREADS.
Index asked_thread_count();

/// The number used for work started by the calling thread: that asked for, but at most four for
/// each core.
Index thread_count();

}  // namespace posewise
