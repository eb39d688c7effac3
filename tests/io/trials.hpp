#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <csignal>
#include <limits>
#include <string>
#include <vector>

#include "posewise/core/random.hpp"
#include "posewise/io/result_files.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::testing {

inline TrialSeries simulated_series(const std::string& variation = "") {
    TrialSeries series;
    series.is_simulated = true;
    series.campaign = "arm \"7\"";
    series.variation = variation;
    series.checksum = "fnv1a64:0123456789abcdef";
    series.seed = std::numeric_limits<std::uint64_t>::max();
    series.criteria = {Criterion::D, Criterion::O1};
    series.pose_counts = {10, 20};
    series.random_subsets = 3;
    series.test_count = 100;
    return series;
}

inline Trial drawn_trial(Index number, Index count = 30) {
    RandomStream stream(7, static_cast<std::uint64_t>(number));
    Trial trial{number, std::vector<double>(static_cast<std::size_t>(count))};
    for (double& value : trial.values) value = stream.normal();
    return trial;
}

inline std::vector<Trial> finished(const TrialStore& store, const TrialSeries& series) {
    std::vector<Trial> trials;
    store.finished(series, [&](const Trial& trial) { trials.push_back(trial); });
    return trials;
}

inline bool is_same(const Trial& a, const Trial& b) {
    const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
    return a.number == b.number && std::ranges::equal(a.values, b.values, {}, bits, bits);
}

inline void expect_same(const std::vector<Trial>& a, const std::vector<Trial>& b) {
    EXPECT_EQ(a.size(), b.size());
    EXPECT_TRUE(std::ranges::equal(a, b, is_same));
}

/// A store of the first trials of a series, at rest.
inline std::string store_of(const TemporaryFolder& folder, const std::string& name, Index begin,
                            Index end, const TrialSeries& series = simulated_series()) {
    const TrialStore store = io::open_trial_store(folder.path(name));
    for (Index k = begin; k < end; ++k) store.keep(series, drawn_trial(k));
    return folder.path(name);
}

inline std::string opening_error(const std::string& path) {
    const std::string error = input_error_of([&] { io::open_trial_store(path); });
    EXPECT_EQ(error.find('\n'), std::string::npos);
    return error;
}

/// A process that keeps trials until it is killed, and tells the number of each on a pipe.
class Writer {
  public:
    Writer(const std::string& path, Index begin) {
        EXPECT_EQ(::pipe(ends_.data()), 0);
        process_ = ::fork();
        if (process_ != 0) {
            ::close(ends_[1]);
            return;
        }
        const TrialStore store = io::open_trial_store(path);
        for (Index k = begin;; ++k) {
            store.keep(simulated_series(k % 2 == 0 ? "even" : "odd"), drawn_trial(k));
            if (::write(ends_[1], &k, sizeof k) != sizeof k) ::_exit(1);
        }
    }
    ~Writer() {
        kill();
        ::close(ends_[0]);
    }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    /// Until one more trial is kept; false if there will be none.
    bool wait() {
        Index number = -1;
        if (::read(ends_[0], &number, sizeof number) != sizeof number) return false;
        last_ = number;
        return true;
    }
    /// The last trial that is known to be kept.
    Index last() const { return last_; }
    void kill() {
        if (process_ > 0) {
            ::kill(process_, SIGKILL);
            ::waitpid(process_, nullptr, 0);
            process_ = 0;
        }
        while (wait()) continue;
    }

  private:
    std::array<int, 2> ends_{};
    pid_t process_ = 0;
    Index last_ = -1;
};

}  // namespace posewise::testing
