#pragma once

#include <algorithm>
#include <chrono>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <type_traits>
#include <vector>

#include "posewise/task/study.hpp"

/// What the processes of a crew tell each other. Only the main thread sends and receives.
namespace posewise::cli::mpi {

constexpr int leader = 0;

enum class Tag {
    // From the leader:
    Begin,  ///< run the program
    Work,   ///< Jobs, to be computed behind those one has
    Drop,   ///< forget the Jobs one has; to be answered by Dropped
    End,    ///< there will be no more; to be answered by Bye
    // To the leader:
    Result,   ///< position of the trial, its values
    Dropped,  ///< how many
    Failure,  ///< exit code, message: the program failed
    Bye,      ///< the last message
};

struct Message {
    int rank = 0;  ///< who sent it
    Tag tag = Tag::Begin;
    std::string bytes;
};

/// One trial to be computed, and its position in the leader's list.
struct Job {
    std::size_t position = 0;
    TrialId trial;
};

/// Which process this is, from 0, of how many.
int own_rank();
int process_count();

void send(int to, Tag tag, const std::string& bytes = "");
std::optional<Message> receive_if_any();
/// Waits for it without taking the CPU from those that compute.
Message receive();

/// Sleeps a little longer each time.
class Pause {
  public:
    explicit Pause(std::chrono::microseconds longest) : longest_(longest) {}
    void operator()() {
        std::this_thread::sleep_for(next_);
        next_ = std::min(2 * next_, longest_);
    }

  private:
    std::chrono::microseconds next_{20};
    std::chrono::microseconds longest_;
};

template <class Value>
std::string to_bytes(const std::vector<Value>& values) {
    static_assert(std::is_trivially_copyable_v<Value>);
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

template <class Value>
std::vector<Value> from_bytes(std::string_view bytes) {
    static_assert(std::is_trivially_copyable_v<Value>);
    std::vector<Value> values(bytes.size() / sizeof(Value));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(Value));
    return values;
}

}  // namespace posewise::cli::mpi
