#pragma once

#include <functional>

#include "posewise/core/types.hpp"

namespace posewise::detail {

/// body(i) for every i from 0 to count - 1, over the threads. The body writes its results by index,
/// so that they do not depend on the number of threads. Of the exceptions it throws, of any type,
/// that of the lowest index is thrown here; indices above one that failed may be left out.
void for_each_index(Index count, const std::function<void(Index index)>& body);

/// The same in runs of `grain` indices (the last one shorter), body(first, last) for those from
/// first to last - 1: for short bodies, and for those that share memory to work in.
void for_each_range(Index count, Index grain,
                    const std::function<void(Index first, Index last)>& body);

}  // namespace posewise::detail
