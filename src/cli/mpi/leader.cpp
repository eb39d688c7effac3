#include "leader.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <tuple>
#include <utility>

#include "cli/crew.hpp"
#include "messages.hpp"
#include "posewise/core/progress.hpp"

namespace posewise::cli::mpi {
namespace {

/// More that wait in a process are of no use: the leader is seldom a millisecond away.
constexpr std::size_t most_ahead = 8;

/// Positions of a list that nobody has taken.
class Untaken {
  public:
    explicit Untaken(std::size_t count) : count_(count) {}

    std::size_t count() const { return count_ - std::min(next_.load(), count_); }
    /// From first to last - 1, at most so many.
    std::pair<std::size_t, std::size_t> take(std::size_t most) {
        const std::size_t first = next_.fetch_add(most);
        return {std::min(first, count_), std::min(first + most, count_)};
    }
    void close() { next_ = count_; }

  private:
    std::size_t count_;
    std::atomic<std::size_t> next_{0};
};

struct Found {
    std::size_t position = 0;
    std::vector<double> values;
};

/// A thread of the leader that takes and computes trials, one by one, until none is left.
class OwnTrials {
  public:
    OwnTrials(const ComputeTrial& compute, const std::vector<TrialId>& trials, Untaken& untaken)
        : untaken_(untaken), thread_([this, &compute, &trials, threads = thread_count()] {
              set_thread_count(threads);
              work(compute, trials);
          }) {}
    ~OwnTrials() {
        untaken_.close();
        thread_.join();
    }
    OwnTrials(const OwnTrials&) = delete;
    OwnTrials& operator=(const OwnTrials&) = delete;

    /// What was found since the last call, and whether that is all. Throws what a trial threw.
    std::pair<std::vector<Found>, bool> collect() {
        const std::lock_guard lock(mutex_);
        if (failure_) std::rethrow_exception(failure_);
        return {std::exchange(found_, {}), is_done_};
    }

  private:
    void work(const ComputeTrial& compute, const std::vector<TrialId>& trials) {
        try {
            for (auto [i, end] = untaken_.take(1); i < end; std::tie(i, end) = untaken_.take(1)) {
                std::vector<double> values = compute(trials[i]);
                const std::lock_guard lock(mutex_);
                found_.push_back({i, std::move(values)});
            }
        } catch (...) {
            const std::lock_guard lock(mutex_);
            failure_ = std::current_exception();
        }
        const std::lock_guard lock(mutex_);
        is_done_ = true;
    }

    Untaken& untaken_;
    std::mutex mutex_;
    std::vector<Found> found_;
    std::exception_ptr failure_;
    bool is_done_ = false;
    std::thread thread_;
};

/// What the other processes have and have not answered.
class Others {
  public:
    Others() : unanswered_(static_cast<std::size_t>(process_count()), 0) {}

    bool are_idle() const {
        return std::all_of(unanswered_.begin(), unanswered_.end(), [](auto n) { return n == 0; });
    }

    /// A few to each that has not enough, fewer towards the end, where all shall end together.
    void hand_out(const std::vector<TrialId>& trials, Untaken& untaken) {
        for (std::size_t rank = 1; rank < unanswered_.size(); ++rank) {
            const std::size_t share = untaken.count() / (2 * unanswered_.size());
            const std::size_t ahead = std::clamp<std::size_t>(share, 1, most_ahead);
            if (unanswered_[rank] > ahead / 2) continue;
            std::vector<Job> jobs;
            auto [i, end] = untaken.take(ahead - unanswered_[rank]);
            for (; i < end; ++i) jobs.push_back({i, trials[i]});
            if (jobs.empty()) return;
            send(static_cast<int>(rank), Tag::Work, to_bytes(jobs));
            unanswered_[rank] += jobs.size();
        }
    }

    void drop() {
        for (std::size_t rank = 1; rank < unanswered_.size(); ++rank) {
            if (unanswered_[rank] == 0) continue;
            send(static_cast<int>(rank), Tag::Drop);
            ++unanswered_[rank];
        }
    }

    /// What a process found since the last call; nothing if none has sent it.
    std::optional<Found> collect() {
        while (const std::optional<Message> message = receive_if_any()) {
            const std::string_view bytes = message->bytes;
            std::size_t& unanswered = unanswered_[static_cast<std::size_t>(message->rank)];
            if (message->tag == Tag::Failure) {
                const std::string text(bytes.substr(sizeof(int)));
                throw ProgramEnd{from_bytes<int>(bytes.substr(0, sizeof(int))).front(), text};
            }
            const auto number = from_bytes<std::size_t>(bytes.substr(0, sizeof(std::size_t)));
            if (message->tag == Tag::Dropped) {
                unanswered -= 1 + number.front();
                continue;
            }
            --unanswered;
            return Found{number.front(), from_bytes<double>(bytes.substr(sizeof(std::size_t)))};
        }
        return std::nullopt;
    }

  private:
    std::vector<std::size_t> unanswered_;  ///< messages each owes, by rank
};

}  // namespace

void lead_trials(const ComputeTrial& compute, const std::vector<TrialId>& trials,
                 const AcceptTrial& accept, const StopSignal& stop) {
    const Pause shortest(std::chrono::milliseconds(1));
    Pause pause = shortest;
    Untaken untaken(trials.size());
    Others others;
    others.hand_out(trials, untaken);
    OwnTrials own(compute, trials, untaken);
    for (bool is_stopped = false, is_done = false; !is_done;) {
        if (!is_stopped && stop.is_set()) {
            is_stopped = true;
            untaken.close();
            others.drop();
        }
        auto [found, own_done] = own.collect();
        const bool is_quiet = found.empty();
        for (Found& one : found) accept(one.position, std::move(one.values));
        bool is_silent = true;
        while (std::optional<Found> one = others.collect()) {
            accept(one->position, std::move(one->values));
            others.hand_out(trials, untaken);
            is_silent = false;
        }
        others.hand_out(trials, untaken);
        is_done = own_done && others.are_idle();
        if (is_quiet && is_silent && !is_done) {
            pause();
        } else {
            pause = shortest;
        }
    }
}

}  // namespace posewise::cli::mpi
