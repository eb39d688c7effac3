#pragma once

#include <mutex>

#include "posewise/core/progress.hpp"

namespace posewise::detail {

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

}  // namespace posewise::detail
