#pragma once

#include <cstdlib>

#ifdef __GLIBC__  // only after another header
#include <malloc.h>
#endif

namespace posewise {

/// Memory that was freed is kept, as by the program: a third of the time else.
[[maybe_unused]] inline const bool keeps_freed_memory = [] {
#ifdef __GLIBC__
    constexpr int mebibyte = 1 << 20;
    return mallopt(M_MMAP_THRESHOLD, 32 * mebibyte) == 1 &&
           mallopt(M_TRIM_THRESHOLD, 256 * mebibyte) == 1;
#else
    return false;
#endif
}();

}  // namespace posewise
