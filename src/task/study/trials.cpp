#include <mutex>

#include "core/parallel.hpp"
#include "posewise/task/study.hpp"

namespace posewise {

void run_on_threads(const ComputeTrial& compute,
                    const std::function<void(const RunTrials&)>& lead) {
    std::mutex mutex;
    lead(
        [&](const std::vector<TrialId>& trials, const AcceptTrial& accept, const StopSignal& stop) {
            detail::for_each_index(static_cast<Index>(trials.size()), [&](Index i) {
                if (stop.is_set()) return;
                const auto position = static_cast<std::size_t>(i);
                std::vector<double> values = compute(trials[position]);
                const std::lock_guard lock(mutex);
                accept(position, std::move(values));
            });
        });
}

}  // namespace posewise
