#pragma once

/// Hot loops in explicit vectors, compiled for several instruction sets and chosen when the program
/// runs, so that a package built for any x86-64 uses what the machine has. A kernel is a struct
/// with a member template `template <typename V> void run() const`, V a vector of doubles;
/// everything it calls must be POSEWISE_INLINE to be compiled for the same instruction set. Digits
/// do not depend on the width: kernels sum in an order of their own, and all is compiled without
/// fused multiplication and addition (-ffp-contract=off), which not every width has.
#define POSEWISE_INLINE [[gnu::always_inline]] inline

namespace posewise::detail::simd {

template <int Width>
struct VectorOf {
    using type [[gnu::vector_size(8 * Width)]] = double;
};
using V2 = VectorOf<2>::type;
using V4 = VectorOf<4>::type;
using V8 = VectorOf<8>::type;

/// Floats in as many bytes as V.
template <typename V>
struct FloatsOf {
    using type [[gnu::vector_size(sizeof(V))]] = float;
};

template <typename V>
constexpr int width = static_cast<int>(sizeof(V) / sizeof(double));
constexpr int most_lanes = width<V8>;

#if defined(__x86_64__)
template <typename Kernel>
[[gnu::target("avx512f,avx512dq,avx2")]] void run_avx512(const Kernel& kernel) {
    kernel.template run<V8>();
}
template <typename Kernel>
[[gnu::target("avx2")]] void run_avx2(const Kernel& kernel) {
    kernel.template run<V4>();
}
#endif

/// Doubles in the widest vector that this CPU has: 2, 4 or 8.
int widest();

/// The width in use: at first the widest. For tests: no narrower or wider than the CPU can.
void use_width(int width);
int width_in_use();

template <typename Kernel>
void run(const Kernel& kernel) {
#if defined(__x86_64__)
    if (width_in_use() == 8) return run_avx512(kernel);
    if (width_in_use() == 4) return run_avx2(kernel);
#endif
    kernel.template run<V2>();
}

}  // namespace posewise::detail::simd
