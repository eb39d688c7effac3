#pragma once

#include <functional>
#include <limits>
#include <mutex>

#include "posewise/core/types.hpp"

namespace posewise {

/// How far a long computation has come, in parts of it (starts, folds, cases). Computations fill
/// in what they know.
struct Progress {
    Index done = 0;
    Index total = 0;
    double value = -std::numeric_limits<double>::infinity();  ///< of the best plan so far
    double bound = std::numeric_limits<double>::infinity();   ///< no plan has a larger value
    double efficiency = 0;  ///< of the value against the bound, from 0 to 1
};

/// Called from one thread at a time. What it throws ends the computation and reaches its caller.
using ProgressCallback = std::function<void(const Progress&)>;

/// Counts the parts that are done, whichever thread did them, and tells the callback.
class ProgressCounter {
  public:
    /// The callback may be empty; it must live as long as the counter.
    ProgressCounter(const ProgressCallback& callback, const Progress& begin)
        : callback_(callback), progress_(begin) {}
    ProgressCounter(const ProgressCallback& callback, Index total)
        : ProgressCounter(callback, Progress{.total = total}) {}

    /// One more part is done; `update(Progress&)` states what else is new.
    template <typename Update>
    void count(const Update& update) {
        if (!callback_) return;
        const std::lock_guard lock(mutex_);
        ++progress_.done;
        update(progress_);
        callback_(progress_);
    }
    void count() {
        count([](Progress&) {});
    }

  private:
    const ProgressCallback& callback_;
    Progress progress_;
    std::mutex mutex_;
};

}  // namespace posewise
