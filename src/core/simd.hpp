#pragma once

/// Hot loops in explicit vectors, compiled for several instruction sets and chosen when the program
/// runs, so that a package built for any x86-64 uses what the machine has. A kernel is a struct
/// with a member template `template <typename V> void run() const`, V a vector of doubles;
/// everything it calls must be POSEWISE_INLINE to be compiled for the same instruction set.
#define POSEWISE_INLINE [[gnu::always_inline]] inline

namespace posewise::detail::simd {

template <int Width>
struct VectorOf {
    using type [[gnu::vector_size(8 * Width)]] = double;
};
using V2 = VectorOf<2>::type;
using V4 = VectorOf<4>::type;
using V8 = VectorOf<8>::type;

template <typename V>
constexpr int width = static_cast<int>(sizeof(V) / sizeof(double));

#if defined(__x86_64__)
template <typename Kernel>
[[gnu::target("avx512f,avx512dq,avx2,fma")]] void run_avx512(const Kernel& kernel) {
    kernel.template run<V8>();
}
template <typename Kernel>
[[gnu::target("avx2,fma")]] void run_avx2(const Kernel& kernel) {
    kernel.template run<V4>();
}
#endif

template <typename Kernel>
void run(const Kernel& kernel) {
#if defined(__x86_64__)
    static const bool has_avx512 =
        __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0;
    static const bool has_avx2 =
        __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
    if (has_avx512) return run_avx512(kernel);
    if (has_avx2) return run_avx2(kernel);
#endif
    kernel.template run<V2>();
}

}  // namespace posewise::detail::simd
