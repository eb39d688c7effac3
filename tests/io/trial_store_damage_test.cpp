#include <gtest/gtest.h>

#include "../../src/io/format/atomic_file.hpp"
#include "trials.hpp"

namespace posewise::io {
namespace {

using detail::read_file;
using namespace testing;

/// A file with up to 40 bytes overwritten or, every fourth time, all behind them cut off.
std::string damage(std::string content, std::uint64_t number) {
    RandomStream stream(11, number);
    const auto place = static_cast<std::size_t>(stream.index(std::ssize(content)));
    const auto wanted = static_cast<std::size_t>(1 + stream.index(number % 3 == 0 ? 1 : 40));
    const std::size_t end = std::min(place + wanted, content.size());
    for (std::size_t k = place; k < end; ++k) content[k] = static_cast<char>(stream.index(256));
    if (number % 4 == 0) content.resize(place);
    return content;
}

TEST(TrialStore, TakesNoDamageForNumbers) {
    const TemporaryFolder folder;
    std::vector<Trial> trials;
    for (Index k = 0; k < 60; ++k) trials.push_back(drawn_trial(k));
    const std::string content = read_file(store_of(folder, "a.sqlite", 0, 60));
    const std::string path = folder.path("damaged.sqlite");
    int refused = 0;
    for (std::uint64_t k = 0; k < 300; ++k) {
        folder.write("damaged.sqlite", damage(content, k));
        const std::string error = input_error_of([&] {
            const TrialStore store = k % 2 == 0 ? open_trial_store(path) : read_trial_store(path);
            expect_same(finished(store, simulated_series()), trials);  // all of them, or none
        });
        EXPECT_TRUE(error == "no error" || error.starts_with("damaged.sqlite: ")) << error;
        EXPECT_EQ(error.find('\n'), std::string::npos) << error;
        refused += error != "no error" ? 1 : 0;
        ASSERT_FALSE(HasFailure()) << "case " << k;
    }
    EXPECT_GT(refused, 100);
}

/// What is in the log only, and damaged there, is lost; that is no error, for so are trials in
/// flight.
TEST(TrialStore, TakesNoDamageOfItsLogForNumbers) {
    const TemporaryFolder folder;
    const std::string path = folder.path("a.sqlite");
    std::vector<std::string> contents;
    {
        Writer writer(path, 0);
        for (int k = 0; k < 100; ++k) ASSERT_TRUE(writer.wait());
    }
    const std::array suffixes{"", "-wal", "-shm"};
    for (const std::string suffix : suffixes) contents.push_back(read_file(path + suffix));
    std::size_t most = 0;
    for (std::uint64_t k = 0; k < 100; ++k) {
        for (std::size_t i = 0; i < suffixes.size(); ++i) {
            const bool is_damaged = i == 1 || (i == 2 && k % 2 == 0);
            folder.write(std::string("a.sqlite") + suffixes[i],
                         is_damaged ? damage(contents[i], k) : contents[i]);
        }
        const std::string error = input_error_of([&] {
            const TrialStore store = k % 3 == 0 ? open_trial_store(path) : read_trial_store(path);
            const std::vector<Trial> even = finished(store, simulated_series("even"));
            for (const Trial& trial : even) {
                EXPECT_TRUE(is_same(trial, drawn_trial(trial.number)));
            }
            most = std::max(most, even.size());
        });
        EXPECT_TRUE(error == "no error" || error.starts_with("a.sqlite: ")) << error;
        ASSERT_FALSE(HasFailure()) << "case " << k;
    }
    EXPECT_GT(most, 20U);
}

}  // namespace
}  // namespace posewise::io
