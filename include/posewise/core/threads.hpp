#pragma once

#include "posewise/core/types.hpp"

namespace posewise {

/// So many threads compute what is asked for from this thread from now on; by default one a core,
/// or as OMP_NUM_THREADS says. No result depends on it. Throws InputError for less than 1.
void set_thread_count(Index count);

/// So many threads compute what is asked for from this thread.
Index thread_count();

}  // namespace posewise
