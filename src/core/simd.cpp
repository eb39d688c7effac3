#include "simd.hpp"

#include <algorithm>
#include <atomic>

namespace posewise::detail::simd {
namespace {

std::atomic<int> used = widest();

}  // namespace

int widest() {
#if defined(__x86_64__)
    __builtin_cpu_init();  // this may run before main
    if (__builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0) return 8;
    if (__builtin_cpu_supports("avx2") != 0) return 4;
#endif
    return 2;
}

void use_width(int width) { used = std::min(width, widest()); }

int width_in_use() { return used.load(std::memory_order_relaxed); }

}  // namespace posewise::detail::simd
