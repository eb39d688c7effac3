#include <gtest/gtest.h>

#include "posewise/core/progress.hpp"

namespace posewise {
namespace {

TEST(FixCacheSizes, DecidesWhatEigenBlocksItsProductsBy) {
    const std::ptrdiff_t before = Eigen::l1CacheSize();
    fix_cache_sizes(48 * 1024);
    EXPECT_EQ(Eigen::l1CacheSize(), 48 * 1024);
    fix_cache_sizes();
    EXPECT_EQ(Eigen::l1CacheSize(), 32 * 1024);
    fix_cache_sizes(before);
}

}  // namespace
}  // namespace posewise
