#pragma once

#include "posewise/core/types.hpp"

namespace posewise {

/// Fixes the cache sizes that Eigen blocks its products by, for the whole process. Eigen asks the
/// CPU for them, so the order of its sums, and with it the last digits of every result, would
/// depend on the type of CPU. The program calls this first; so should every program that uses the
/// library and wants its digits. `level1` in bytes; another one than the default serves to test
/// that nothing depends on it.
void fix_cache_sizes(Index level1 = 32 * 1024);

}  // namespace posewise
