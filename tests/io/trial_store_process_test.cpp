#include <gtest/gtest.h>
#include <sys/resource.h>

#include "trials.hpp"

namespace posewise::io {
namespace {

using namespace testing;

TEST(TrialStore, LosesNothingThatWasKeptWhenItsProcessIsKilled) {
    const TemporaryFolder folder;
    const std::string path = folder.path("a.sqlite");
    Index next = 0;
    for (int life = 0; life < 12; ++life) {
        Writer writer(path, next);
        for (int k = 0; k < 37 * life; ++k) ASSERT_TRUE(writer.wait());
        writer.kill();
        if (writer.last() >= 0) next = writer.last() + 1;
        const TrialStore store = life % 2 == 0 ? open_trial_store(path) : read_trial_store(path);
        std::size_t count = 0;
        for (const Index parity : {0, 1}) {
            for (const Trial& trial :
                 finished(store, simulated_series(parity == 0 ? "even" : "odd"))) {
                EXPECT_EQ(trial.number % 2, parity);
                EXPECT_TRUE(is_same(trial, drawn_trial(trial.number)));
                ++count;
            }
        }
        ASSERT_GE(count, static_cast<std::size_t>(next));  // one more may have been in flight
        ASSERT_LE(count, static_cast<std::size_t>(next) + 1);
    }
    EXPECT_GT(next, 20);
}

TEST(TrialStore, IsWrittenByOneAndReadByMany) {
    const TemporaryFolder folder;
    const std::string path = folder.path("a.sqlite");
    Writer writer(path, 0);
    ASSERT_TRUE(writer.wait());
    const std::string refusal =
        "a.sqlite: is being written by another process; each must have a store of its own, to be "
        "joined by --merge";
    EXPECT_EQ(opening_error(path), refusal);
    std::filesystem::create_symlink(path, folder.path("link"));
    EXPECT_NE(opening_error(folder.path("link")).find("is being written"), std::string::npos);
    for (int k = 0; k < 20; ++k) {
        ASSERT_TRUE(writer.wait());
        const auto even = finished(read_trial_store(path), simulated_series("even"));
        ASSERT_GE(std::ssize(even), writer.last() / 2 + 1);
        expect_same({even.back()}, {drawn_trial(even.back().number)});
    }
    const std::string copy = folder.path("copy.sqlite");
    merge_trial_stores({path}, copy);
    EXPECT_EQ(series_in_store(copy).size(), 2U);
    writer.kill();
    EXPECT_EQ(opening_error(path), "no error");
    EXPECT_EQ(input_error_of([&] {
                  const TrialStore first = open_trial_store(path);
                  open_trial_store(path);
              }),
              refusal);
    EXPECT_EQ(
        input_error_of([&] { read_trial_store(path).keep(simulated_series(), drawn_trial(0)); }),
        "a.sqlite: is only read; must be opened to keep trials");
}

TEST(TrialStore, SeesThatItsFileIsGone) {
    const TemporaryFolder folder;
    const std::string path = folder.path("a.sqlite");
    const TrialStore store = open_trial_store(path);
    store.keep(simulated_series(), drawn_trial(0));
    std::filesystem::rename(path, folder.path("b.sqlite"));
    EXPECT_EQ(input_error_of([&] { store.keep(simulated_series(), drawn_trial(1)); }),
              "a.sqlite: was moved or removed while it was written");
}

/// With the rights of nobody in particular, which superusers' tests would not have.
class WithoutRights {
  public:
    WithoutRights() : is_root_(::geteuid() == 0) {
        if (is_root_ && ::seteuid(65534) != 0) std::abort();
    }
    ~WithoutRights() {
        if (is_root_ && ::seteuid(0) != 0) std::abort();
    }

  private:
    bool is_root_;
};

TEST(TrialStore, IsReadButNotWrittenInAReadOnlyFolder) {
    using std::filesystem::perms;
    const TemporaryFolder folder;
    const std::string path = store_of(folder, "a.sqlite", 0, 3);
    const std::filesystem::path whole(path);
    const perms writing = perms::owner_write | perms::group_write | perms::others_write;
    std::filesystem::permissions(whole.parent_path(), perms::all & ~writing);
    {
        const WithoutRights without_rights;
        EXPECT_EQ(opening_error(path), "a.sqlite: cannot be written: Permission denied");
        EXPECT_EQ(opening_error(folder.path("new.sqlite")),
                  "new.sqlite: cannot be written: Permission denied");
        EXPECT_EQ(finished(read_trial_store(path), simulated_series()).size(), 3U);
    }
    std::filesystem::permissions(whole.parent_path(), perms::all);
    std::filesystem::permissions(whole, writing, std::filesystem::perm_options::remove);
    {
        const WithoutRights without_rights;
        EXPECT_EQ(opening_error(path),
                  "a.sqlite: must not be written; must be writable, as must its folder");
    }
    EXPECT_EQ(folder.file_count(), 1U);
}

/// Files of this process cannot grow beyond so many bytes, as on a full disk.
class SmallDisk {
  public:
    explicit SmallDisk(rlim_t bytes) : handler_(::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit now{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &now);
    }
    ~SmallDisk() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        ::signal(SIGXFSZ, handler_);
    }

  private:
    rlimit before_{};
    void (*handler_)(int);
};

TEST(TrialStore, KeepsWhatItHasOnAFullDisk) {
    const TemporaryFolder folder;
    const std::string path = folder.path("a.sqlite");
    Index kept = 0;
    {
        const TrialStore store = open_trial_store(path);
        const SmallDisk small(200000);
        std::string error;
        for (; error.empty() || error == "no error"; ++kept) {
            error = input_error_of([&] { store.keep(simulated_series(), drawn_trial(kept)); });
        }
        EXPECT_TRUE(error.starts_with("a.sqlite: cannot be read or written: ")) << error;
        --kept;
        EXPECT_GT(kept, 10);
        EXPECT_EQ(std::ssize(finished(store, simulated_series())), kept);
    }
    EXPECT_EQ(std::ssize(finished(read_trial_store(path), simulated_series())), kept);
    {
        const SmallDisk small(1000);
        EXPECT_TRUE(opening_error(folder.path("new.sqlite"))
                        .starts_with("new.sqlite: cannot be read or written: "));
        EXPECT_THROW(merge_trial_stores({path}, folder.path("new.sqlite")), InputError);
    }
    EXPECT_EQ(folder.file_count(), 1U);
    store_of(folder, "a.sqlite", kept, kept + 10);
}

}  // namespace
}  // namespace posewise::io
