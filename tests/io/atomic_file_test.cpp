#include "../../src/io/format/atomic_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <thread>
#include <vector>

#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using namespace detail;

using testing::input_error_of;
using testing::TemporaryFolder;

TEST(WriteFile, ReplacesTheWholeFileAndLeavesNothingElse) {
    const TemporaryFolder folder;
    const std::string path = folder.write("a.txt", "a longer text than the new one");
    write_file(path, "new");
    EXPECT_EQ(read_file(path), "new");
    EXPECT_EQ(folder.file_count(), 1U);
}

TEST(WriteFile, TakesTheNextNameWhereATemporaryOneIsTaken) {
    const TemporaryFolder folder;
    for (int k = 0; k < 1000; ++k) {  // as left by a program with this number, killed
        folder.write(".posewise." + std::to_string(::getpid()) + '.' + std::to_string(k) + ".tmp",
                     "left");
    }
    write_file(folder.path("a.txt"), "new");
    EXPECT_EQ(read_file(folder.path("a.txt")), "new");
    EXPECT_EQ(folder.file_count(), 1001U);
}

TEST(WriteFile, KeepsThePermissionsOfWhatItReplaces) {
    using std::filesystem::perms;
    const TemporaryFolder folder;
    const std::string path = folder.write("a.txt", "old");
    for (const perms kept : {perms::owner_read | perms::owner_write,
                             perms::owner_all | perms::group_read | perms::others_write}) {
        std::filesystem::permissions(path, kept);
        write_file(path, "new");
        EXPECT_EQ(std::filesystem::status(path).permissions(), kept);
    }
}

TEST(WriteFiles, WritesAllOrNone) {
    const TemporaryFolder folder;
    const std::string old = folder.write("a.txt", "old");
    const std::string too_long = folder.path(std::string(300, 'n'));
    EXPECT_THROW(write_files({{old, "new"}, {folder.path("b.txt"), "new"}, {too_long, "new"}}),
                 InputError);
    EXPECT_EQ(read_file(old), "old");
    EXPECT_EQ(folder.file_count(), 1U);
    write_files({{old, "new"}, {folder.path("b.txt"), "new"}});
    EXPECT_EQ(read_file(old), "new");
    EXPECT_EQ(read_file(folder.path("b.txt")), "new");
    EXPECT_EQ(folder.file_count(), 2U);
}

TEST(WriteFiles, TakesALongTextInParts) {
    const TemporaryFolder folder;
    const std::string path = folder.write("a.txt", "old");
    int count = 0;
    const auto write_parts = [&](const std::function<void(std::string_view)>& write) {
        for (int k = 0; k < count; ++k) write("part " + std::to_string(k) + '\n');
        if (count > 2) throw InputError("no more");
    };
    write_files({{path, "begin\n", {}, write_parts}});
    EXPECT_EQ(read_file(path), "begin\n");
    count = 2;
    write_files({{path, "begin\n", {}, write_parts}});
    EXPECT_EQ(read_file(path), "begin\npart 0\npart 1\n");
    count = 3;
    EXPECT_EQ(input_error_of([&] { write_files({{path, "", {}, write_parts}}); }), "no more");
    EXPECT_EQ(read_file(path), "begin\npart 0\npart 1\n");
    EXPECT_EQ(folder.file_count(), 1U);
}

TEST(ReadFile, EndsADeviceThatDoesNot) {
    EXPECT_EQ(input_error_of([&] { read_file("/dev/zero"); }),
              "/dev/zero: is larger than 1 MiB; must be smaller");
    EXPECT_EQ(read_file("/dev/null"), "");
}

TEST(WriteFile, ReplacesTheFileBehindALink) {
    const TemporaryFolder folder;
    const std::string path = folder.write("a.txt", "old");
    std::filesystem::create_symlink(path, folder.path("link"));
    write_file(folder.path("link"), "new");
    EXPECT_EQ(read_file(path), "new");
    EXPECT_TRUE(std::filesystem::is_symlink(folder.path("link")));
}

TEST(WriteFile, WritesToADeviceWithoutReplacingIt) {
    write_file("/dev/null", "text");
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(WriteFile, WritesToAPipeThatHasNoPlaceInAnyFolder) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    write_file("/dev/fd/" + std::to_string(ends[1]), "text");
    std::array<char, 8> read{};
    EXPECT_EQ(::read(ends[0], read.data(), read.size()), 4);
    EXPECT_STREQ(read.data(), "text");
    for (const int end : ends) ::close(end);
}

TEST(WriteFile, WritesOnlyWhatPassesACheck) {
    const TemporaryFolder folder;
    const std::string path = folder.write("a.txt", "old");
    const auto refuse = [](const std::string& written) {
        EXPECT_EQ(read_file(written), "new");
        throw InputError("not this");
    };
    EXPECT_EQ(input_error_of([&] { write_file(path, "new", refuse); }), "not this");
    EXPECT_EQ(read_file(path), "old");
    EXPECT_EQ(folder.file_count(), 1U);
    write_file(path, "new", [](const std::string&) {});
    EXPECT_EQ(read_file(path), "new");
    EXPECT_EQ(folder.file_count(), 1U);
    EXPECT_EQ(input_error_of([&] { write_file("/dev/null", "new", refuse); }),
              "/dev/null: cannot be read back; must be a file");
}

TEST(WriteFile, RefusesAFolder) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.path("a"));
    EXPECT_EQ(input_error_of([&] { write_file(folder.path("a"), "text"); }),
              "a: is a directory; must be the name of a file to write");
    EXPECT_EQ(folder.file_count(), 1U);
}

TEST(WriteFile, RefusesAFolderThatDoesNotExist) {
    const TemporaryFolder folder;
    EXPECT_EQ(input_error_of([&] { write_file(folder.path("a/b.txt"), "text"); }),
              "a/b.txt: cannot be written: No such file or directory");
}

TEST(WriteFile, RefusesALinkThatLeadsNowhere) {
    const TemporaryFolder folder;
    std::filesystem::create_symlink("b", folder.path("a"));
    std::filesystem::create_symlink("a", folder.path("b"));
    const std::string message = input_error_of([&] { write_file(folder.path("a"), "text"); });
    EXPECT_EQ(message.rfind("a: is a link that leads nowhere", 0), 0U) << message;
    EXPECT_TRUE(std::filesystem::is_symlink(folder.path("a")));
    EXPECT_EQ(folder.file_count(), 2U);
}

TEST(WriteFile, MakesTheFileBehindALink) {
    const TemporaryFolder folder;
    std::filesystem::create_symlink("b", folder.path("a"));
    write_file(folder.path("a"), "text");
    EXPECT_EQ(read_file(folder.path("b")), "text");
    EXPECT_TRUE(std::filesystem::is_symlink(folder.path("a")));
}

TEST(WriteFile, TakesTheLongestNames) {
    const TemporaryFolder folder;
    write_file(folder.path(std::string(255, 'n')), "text");
    EXPECT_EQ(folder.file_count(), 1U);
}

TEST(WriteFile, SaysThatTheDiskIsFull) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs the device /dev/full";
    EXPECT_EQ(input_error_of([] { write_file("/dev/full", "text"); }),
              "/dev/full: cannot be written: No space left on device");
}

/// Those that end this program: what was started in the background may ignore some.
std::vector<int> ending_signals() {
    std::vector<int> signals;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction now = {};
        ::sigaction(signal, nullptr, &now);
        if (now.sa_handler != SIG_IGN) signals.push_back(signal);
    }
    return signals;
}

/// Until it is ended.
[[noreturn]] void write_forever(const std::string& path) noexcept {
    for (;;) write_file(path, std::string(1 << 16, 'x'));
}

TEST(WriteFile, LeavesNoTemporaryFileWhenASignalEndsTheProgram) {
    for (const int signal : ending_signals()) {
        for (int k = 0; k < 5; ++k) {
            const TemporaryFolder folder;
            const std::string path = folder.path("a");
            const pid_t child = ::fork();
            if (child == 0) write_forever(path);
            while (!std::filesystem::exists(path)) std::this_thread::yield();
            std::this_thread::sleep_for(std::chrono::microseconds(700 * k));
            ::kill(child, signal);
            int status = 0;
            ::waitpid(child, &status, 0);
            EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
            EXPECT_EQ(folder.file_count(), 1U);
        }
    }
}

TEST(WriteFile, EndsByASignalWhileNobodyReadsThePipe) {
    const TemporaryFolder folder;
    const std::string pipe = folder.path("pipe");
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    const std::string file = folder.path("a");
    for (const int signal : ending_signals()) {
        const pid_t child = ::fork();
        if (child == 0) {
            write_files({{file, "text"}, {pipe, "text"}});
            ::_exit(0);
        }
        while (!std::filesystem::exists(file)) std::this_thread::yield();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        ::kill(child, signal);
        int status = 0;
        for (int k = 0; k < 500 && ::waitpid(child, &status, WNOHANG) == 0; ++k) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        const bool has_ended = WIFSIGNALED(status) && WTERMSIG(status) == signal;
        EXPECT_TRUE(has_ended) << status;
        if (!has_ended) {
            ::kill(child, SIGKILL);
            ::waitpid(child, &status, 0);
        }
        EXPECT_EQ(read_file(file), "text");
        std::filesystem::remove(file);
        EXPECT_EQ(folder.file_count(), 1U);
    }
}

TEST(ReadFile, StopsAtTheLargestSize) {
    const TemporaryFolder folder;
    EXPECT_EQ(read_file(folder.write("a", "four"), 4), "four");
    EXPECT_EQ(input_error_of([] { read_file("/dev/zero", 1 << 20); }),
              "/dev/zero: is larger than 1 MiB; must be smaller");
}

TEST(ReadFile, KeepsEveryByte) {
    const TemporaryFolder folder;
    const std::string bytes("\0\r\n\xFF", 4);
    EXPECT_EQ(read_file(folder.write("a", bytes)), bytes);
}

}  // namespace
}  // namespace posewise::io
