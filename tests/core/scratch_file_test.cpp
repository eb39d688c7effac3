#include "../../src/core/scratch_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <optional>

#include "posewise/core/errors.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using detail::ScratchFile;

/// An environment's variable for as long as this lives.
class Environment {
  public:
    Environment(const char* name, const std::string& value) : name_(name) {
        if (const char* const before = std::getenv(name)) before_ = before;
        ::setenv(name, value.c_str(), 1);
    }
    ~Environment() {
        if (before_) {
            ::setenv(name_, before_->c_str(), 1);
        } else {
            ::unsetenv(name_);
        }
    }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;

  private:
    const char* name_;
    std::optional<std::string> before_;
};

std::vector<double> numbers_from(double first, std::size_t count) {
    std::vector<double> numbers(count);
    std::iota(numbers.begin(), numbers.end(), first);
    return numbers;
}

TEST(ScratchFile, GivesBackWhatWasWrittenInMemoryAndInTheFile) {
    for (const std::size_t in_memory : {0UL, 10UL, 25UL, 1000UL}) {
        ScratchFile file(in_memory);
        std::vector<std::size_t> places;
        for (int k = 0; k < 10; ++k) {
            places.push_back(file.add_place(8));
            file.write(places.back(), numbers_from(10 * k, 8));
        }
        file.write(places[3] + 2, numbers_from(-5, 2));
        std::vector<double> whole(8), part(3);
        for (int k = 0; k < 10; ++k) {
            file.read(places[static_cast<std::size_t>(k)], whole);
            auto expected = numbers_from(10 * k, 8);
            if (k == 3) expected[2] = -5;
            if (k == 3) expected[3] = -4;
            EXPECT_EQ(whole, expected) << in_memory << " numbers in memory, place " << k;
        }
        file.read(places[7] + 5, part);
        EXPECT_EQ(part, numbers_from(75, 3));
    }
}

TEST(ScratchFile, HasNoNameInTheFolderForTemporaryFiles) {
    const testing::TemporaryFolder folder;
    const Environment environment("TMPDIR", folder.path(""));
    ScratchFile file(0);
    file.add_place(1);
    file.write(0, std::array{1.0});
    EXPECT_TRUE(std::filesystem::is_empty(folder.path("")));
}

TEST(ScratchFile, SaysWhichFolderHasNoRoom) {
    const testing::TemporaryFolder folder;
    {
        const Environment environment("TMPDIR", folder.path("is_not_there"));
        // What is no folder is not taken; then it is the usual one.
        EXPECT_NO_THROW(ScratchFile(0).add_place(1));
    }
    const Environment environment("TMPDIR", folder.path(""));
    ScratchFile file(0);
    file.add_place(1000);
    // As a full disk: no file may become larger than this.
    rlimit before{};
    ::getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{4096, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
    std::string message;
    try {
        file.write(0, numbers_from(0, 1000));
    } catch (const InputError& error) {
        message = error.what();
    }
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_NE(message.find(folder.path("")), std::string::npos) << message;
    EXPECT_NE(message.find("results cannot be kept there for a while: File too large; must have "
                           "room, or TMPDIR name another folder"),
              std::string::npos)
        << message;
}

}  // namespace
}  // namespace posewise
