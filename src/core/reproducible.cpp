#include "posewise/core/progress.hpp"

namespace posewise {

void fix_cache_sizes(Index level1) {
    constexpr Index level2 = 512 * 1024;
    constexpr Index level3 = 32 * 1024 * 1024;
    Eigen::setCpuCacheSizes(level1, level2, level3);
}

}  // namespace posewise
