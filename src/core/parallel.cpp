#include "parallel.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>

#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"

namespace posewise {

void set_thread_count(Index count) {
    if (count < 1) {
        throw InputError("thread count is " + std::to_string(count) + ", must be at least 1");
    }
    omp_set_num_threads(static_cast<int>(count));
}

Index asked_thread_count() { return omp_get_max_threads(); }

Index thread_count() {
    constexpr int most_each = 4;
    return std::min(asked_thread_count(), static_cast<Index>(most_each * omp_get_num_procs()));
}

namespace detail {
namespace {

/// The exception of the lowest index. None may leave an OpenMP region.
class FirstFailure {
  public:
    explicit FirstFailure(Index count) : index_(count) {}

    bool is_before(Index index) const { return index_.load(std::memory_order_relaxed) < index; }

    void keep(Index index, std::exception_ptr failure) {
        const std::lock_guard lock(mutex_);
        if (index >= index_.load()) return;
        index_ = index;
        failure_ = std::move(failure);
    }

    void rethrow() const {
        if (failure_) std::rethrow_exception(failure_);
    }

  private:
    std::atomic<Index> index_;
    std::exception_ptr failure_;
    std::mutex mutex_;
};

}  // namespace

void for_each_index(Index count, const std::function<void(Index)>& body) {
    if (count == 1) return body(0);
    FirstFailure failure(count);
    const int threads = static_cast<int>(thread_count());
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (Index i = 0; i < count; ++i) {
        if (failure.is_before(i)) continue;
        try {
            body(i);
        } catch (...) {
            failure.keep(i, std::current_exception());
        }
    }
    failure.rethrow();
}

void for_each_range(Index count, Index grain, const std::function<void(Index, Index)>& body) {
    for_each_index((count + grain - 1) / grain,
                   [&](Index range) { body(range * grain, std::min(count, (range + 1) * grain)); });
}

}  // namespace detail
}  // namespace posewise
