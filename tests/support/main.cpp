#include <gtest/gtest.h>

#include <cstdlib>

#include "posewise/core/progress.hpp"

/// Every test program runs with fixed cache sizes, POSEWISE_TEST_L1_KIB of the first level (32 if
/// it is not set): results must hold for any, see fix_cache_sizes().
int main(int argc, char** argv) {
    const char* const level1_kib = std::getenv("POSEWISE_TEST_L1_KIB");
    posewise::fix_cache_sizes((level1_kib != nullptr ? std::atol(level1_kib) : 32) * 1024);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
