#include "posewise/io/trial_store.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <csignal>
#include <limits>

#include "../../src/core/checksum.hpp"
#include "../../src/io/atomic_file.hpp"
#include "../../src/io/trial_statement.hpp"
#include "posewise/core/random.hpp"
#include "posewise/core/version.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using detail::read_file;
using testing::input_error_of;
using testing::TemporaryFolder;

TrialSeries simulated_series(const std::string& variation = "") {
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

TrialSeries measured_series() {
    TrialSeries series;
    series.campaign = "arm";
    series.checksum = "fnv1a64:0";
    series.pose_counts = {5};
    series.splits = 4;
    series.ids = {"1", "2", "\xc3\xa9\n"};
    return series;
}

Trial drawn_trial(Index number, Index count = 30) {
    RandomStream stream(7, static_cast<std::uint64_t>(number));
    Trial trial{number, std::vector<double>(static_cast<std::size_t>(count))};
    for (double& value : trial.values) value = stream.normal();
    return trial;
}

bool is_same(const Trial& a, const Trial& b) {
    const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
    return a.number == b.number && std::ranges::equal(a.values, b.values, {}, bits, bits);
}

void expect_same(const std::vector<Trial>& a, const std::vector<Trial>& b) {
    EXPECT_EQ(a.size(), b.size());
    EXPECT_TRUE(std::ranges::equal(a, b, is_same));
}

/// A store of the first trials of a series, at rest.
std::string store_of(const TemporaryFolder& folder, const std::string& name, Index begin, Index end,
                     const TrialSeries& series = simulated_series()) {
    const TrialStore store = open_trial_store(folder.path(name));
    for (Index k = begin; k < end; ++k) store.keep(series, drawn_trial(k));
    return folder.path(name);
}

/// Runs SQL as other programs do.
void run_sql(const std::string& path, const std::string& sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(::sqlite3_open(path.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(::sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << ::sqlite3_errmsg(database);
    ::sqlite3_close(database);
}

std::string opening_error(const std::string& path) {
    const std::string error = input_error_of([&] { open_trial_store(path); });
    EXPECT_EQ(error.find('\n'), std::string::npos);
    return error;
}

TEST(TrialStore, GivesBackEveryBit) {
    using Limits = std::numeric_limits<double>;
    const TemporaryFolder folder;
    const std::string path = folder.path("a.sqlite");
    const std::vector<Trial> trials{
        {0, {0.1, -0.0, Limits::infinity(), -Limits::infinity(), Limits::denorm_min()}},
        {3, {Limits::quiet_NaN(), -Limits::quiet_NaN(), Limits::max(), Limits::lowest()}},
        {5, {}},
        {Index{1} << 40, {std::bit_cast<double>(std::uint64_t{0x7ff8000000001234})}}};
    {
        const TrialStore store = open_trial_store(path);
        for (const std::size_t k : {2U, 0U, 3U, 1U}) store.keep(simulated_series(), trials[k]);
        expect_same(store.finished(simulated_series()), trials);
    }
    EXPECT_EQ(folder.file_count(), 1U);  // no log, no lock
    expect_same(open_trial_store(path).finished(simulated_series()), trials);
    expect_same(read_trial_store(path).finished(simulated_series()), trials);
}

TEST(TrialStore, HoldsSeveralSeries) {
    const TemporaryFolder folder;
    const std::string path = folder.path("a.sqlite");
    std::vector<TrialSeries> all{measured_series(), simulated_series(), simulated_series("x=1")};
    all.push_back(simulated_series());
    all.back().seed = 1;
    for (std::size_t k = 0; k < all.size(); ++k) {  // opened again for each
        open_trial_store(path).keep(all[k], {0, {static_cast<double>(k)}});
    }
    const TrialStore store = open_trial_store(path);
    for (std::size_t k = 0; k < all.size(); ++k) {
        expect_same(store.finished(all[k]), {{0, {static_cast<double>(k)}}});
    }
    EXPECT_TRUE(store.finished(simulated_series("x=2")).empty());
    const std::vector<TrialSeries> found = series_in_store(path);
    EXPECT_EQ(found.size(), all.size());
    for (const TrialSeries& series : all) EXPECT_EQ(std::ranges::count(found, series), 1);
}

TEST(TrialStore, KeepsTheSameTrialTwiceButNoOther) {
    const TemporaryFolder folder;
    const TrialStore store = open_trial_store(folder.path("a.sqlite"));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    store.keep(simulated_series("x=1"), {17, {1, nan}});
    store.keep(simulated_series("x=1"), {17, {1, -nan}});
    for (const std::vector<double>& other : {std::vector<double>{1, 2}, {1}, {1, nan, 0}, {}}) {
        EXPECT_EQ(input_error_of([&] {
                      store.keep(simulated_series("x=1"), {17, other});
                  }),
                  "a.sqlite: trial 17 of campaign 'arm \"7\"', 'x=1', was found with other values "
                  "before, by another machine or program; must be kept in another file");
    }
    expect_same(store.finished(simulated_series("x=1")), {{17, {1, nan}}});
}

TEST(TrialStore, LeavesNoFileWithoutTrials) {
    const TemporaryFolder folder;
    open_trial_store(folder.path("a.sqlite"));
    EXPECT_EQ(folder.file_count(), 0U);
    const std::string empty = folder.write("empty.sqlite", "");
    EXPECT_EQ(input_error_of([&] { read_trial_store(empty); }),
              "empty.sqlite: is empty; must be a store of trials");
    store_of(folder, "empty.sqlite", 0, 1);
    EXPECT_EQ(read_trial_store(empty).finished(simulated_series()).size(), 1U);
}

TEST(TrialStore, RefusesTextThatNoOneCouldRead) {
    const TemporaryFolder folder;
    TrialSeries series = simulated_series("\xff");
    const TrialStore store = open_trial_store(folder.path("a.sqlite"));
    EXPECT_NE(input_error_of([&] { store.keep(series, drawn_trial(0)); }).find("UTF-8"),
              std::string::npos);
    store.keep(simulated_series(), drawn_trial(0));
    EXPECT_EQ(store.finished(simulated_series()).size(), 1U);
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
        const TrialStore store = open_trial_store(path);
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
                 store.finished(simulated_series(parity == 0 ? "even" : "odd"))) {
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
        const auto even = read_trial_store(path).finished(simulated_series("even"));
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

TEST(MergeTrialStores, GivesTheSameInAnyOrder) {
    const TemporaryFolder folder;
    const std::string a = store_of(folder, "a.sqlite", 0, 40);
    const std::string b = store_of(folder, "b.sqlite", 30, 70);
    const std::string c = store_of(folder, "c.sqlite", 0, 10, measured_series());
    const std::string into = store_of(folder, "into.sqlite", 60, 90, simulated_series("x=1"));
    merge_trial_stores({a, b, c}, into);
    merge_trial_stores({into, c, b, a, a}, folder.path("new.sqlite"));
    const std::vector<TrialSeries> series = series_in_store(into);
    EXPECT_EQ(series.size(), 3U);
    EXPECT_EQ(series, series_in_store(folder.path("new.sqlite")));
    for (const TrialSeries& one : series) {
        expect_same(read_trial_store(into).finished(one),
                    read_trial_store(folder.path("new.sqlite")).finished(one));
    }
    EXPECT_EQ(read_trial_store(into).finished(simulated_series()).size(), 70U);
    EXPECT_EQ(folder.file_count(), 5U);
}

TEST(MergeTrialStores, TakesAllOrNothing) {
    const TemporaryFolder folder;
    const std::string a = store_of(folder, "a.sqlite", 0, 40);
    const std::string b = folder.path("b.sqlite");
    open_trial_store(b).keep(simulated_series(), {39, {1.5}});
    EXPECT_EQ(input_error_of([&] {
                  merge_trial_stores({a, b}, folder.path("new.sqlite"));
              }),
              "b.sqlite: trial 39 of campaign 'arm \"7\"', has other values than in a store before "
              "it; one of them must be left out");
    EXPECT_EQ(folder.file_count(), 2U);
    const std::string into = store_of(folder, "into.sqlite", 50, 51);
    for (const std::string& last : {b, folder.path("none.sqlite"), folder.write("text", "text")}) {
        EXPECT_THROW(merge_trial_stores({a, last}, into), InputError);
        expect_same(read_trial_store(into).finished(simulated_series()), {drawn_trial(50)});
    }
    EXPECT_EQ(input_error_of([&] { merge_trial_stores({folder.path("none.sqlite")}, into); }),
              "none.sqlite: cannot be read: No such file or directory");
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
        EXPECT_EQ(read_trial_store(path).finished(simulated_series()).size(), 3U);
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
        EXPECT_EQ(std::ssize(store.finished(simulated_series())), kept);
    }
    EXPECT_EQ(std::ssize(read_trial_store(path).finished(simulated_series())), kept);
    {
        const SmallDisk small(1000);
        EXPECT_TRUE(opening_error(folder.path("new.sqlite"))
                        .starts_with("new.sqlite: cannot be read or written: "));
        EXPECT_THROW(merge_trial_stores({path}, folder.path("new.sqlite")), InputError);
    }
    EXPECT_EQ(folder.file_count(), 1U);
    store_of(folder, "a.sqlite", kept, kept + 10);
}

TEST(TrialStore, RefusesWhatIsNoStore) {
    const TemporaryFolder folder;
    EXPECT_EQ(opening_error(""), "the name of a store of trials is empty; must be a file");
    EXPECT_EQ(opening_error("/dev/null"), "/dev/null: is a device or pipe; must be a file");
    EXPECT_FALSE(std::filesystem::exists("/dev/null-lock"));
    std::filesystem::create_directory(folder.path("folder"));
    EXPECT_EQ(opening_error(folder.path("folder")),
              "folder: is a directory; must be the name of a file");
    EXPECT_EQ(opening_error(folder.path("none/a.sqlite")),
              "none/a.sqlite: cannot be written: No such file or directory");
    for (const std::size_t size : {1U, 80U, 5000U}) {
        const std::string text(size, 'x');
        const std::string path = folder.write("a.csv", text);
        EXPECT_EQ(opening_error(path),
                  "a.csv: is no store of trials, or damaged from its beginning");
        EXPECT_EQ(read_file(path), text);
    }
    run_sql(folder.path("other.sqlite"), "CREATE TABLE a (b)");
    EXPECT_EQ(opening_error(folder.path("other.sqlite")),
              "other.sqlite: is another program's database; must be a store of trials");
    EXPECT_EQ(folder.file_count(), 3U);
    for (const std::string name : {"", "none", "a.csv", "other.sqlite", "folder"}) {
        EXPECT_FALSE(is_trial_store(name.empty() ? name : folder.path(name))) << name;
    }
    EXPECT_FALSE(is_trial_store("/dev/zero"));
    EXPECT_TRUE(is_trial_store(store_of(folder, "b.sqlite", 0, 1)));
}

TEST(TrialStore, RefusesOtherFormatsAndVersions) {
    const TemporaryFolder folder;
    const std::string path = store_of(folder, "a.sqlite", 0, 1);
    const std::string content = read_file(path);
    run_sql(path, "PRAGMA user_version = 2");
    EXPECT_EQ(opening_error(path),
              "a.sqlite: is a store of format 2, of another version of posewise; must be of format "
              "1");
    for (const std::string sql : {"CREATE TABLE other (a)", "DROP TABLE trials",
                                  "CREATE TRIGGER t AFTER INSERT ON trials BEGIN DELETE FROM "
                                  "trials; END"}) {
        folder.write("a.sqlite", content);
        run_sql(path, sql);
        EXPECT_EQ(opening_error(path),
                  "a.sqlite: is damaged; must be a store of trials as it was written");
    }
}

TEST(TrialStore, OfAnotherVersionIsOnlyRead) {
    const TemporaryFolder folder;
    const std::string path = store_of(folder, "a.sqlite", 0, 1);
    std::string statement = detail::trial_statement(simulated_series(), path);
    statement.replace(statement.find(version), std::string(version).size(), "9.9.9");
    const std::string checksum = detail::checksum_of(statement);
    const std::vector<double> values = drawn_trial(0).values;
    detail::Checksum row;
    row.add(checksum + "/0");
    row.add(Eigen::Map<const RowMatrixXd>(values.data(), 1, std::ssize(values)));
    for (std::size_t at = 0; (at = statement.find('\'', at)) != std::string::npos; at += 2) {
        statement.insert(at, 1, '\'');
    }
    run_sql(path, "UPDATE series SET statement = '" + statement + "', checksum = '" + checksum +
                      "'; UPDATE trials SET checksum = '" + row.text() + "'");
    EXPECT_EQ(opening_error(path), "a.sqlite: holds trials of posewise 9.9.9, and this is " +
                                       std::string(version) +
                                       ", which may find other numbers; must be another file");
    EXPECT_EQ(series_in_store(path), std::vector{simulated_series()});
    expect_same(read_trial_store(path).finished(simulated_series()), {drawn_trial(0)});
    EXPECT_THROW(merge_trial_stores({path}, folder.path("b.sqlite")), InputError);
    EXPECT_EQ(folder.file_count(), 1U);
}

/// A store, some bytes of which were changed or cut off, is refused or gives what was put into it.
TEST(TrialStore, TakesNoDamageForNumbers) {
    const TemporaryFolder folder;
    std::vector<Trial> trials;
    for (Index k = 0; k < 60; ++k) trials.push_back(drawn_trial(k));
    const std::string content = read_file(store_of(folder, "a.sqlite", 0, 60));
    const std::string path = folder.path("damaged.sqlite");
    int refused = 0;
    for (std::uint64_t k = 0; k < 400; ++k) {
        RandomStream stream(11, k);
        std::string damaged = content;
        const auto place = static_cast<std::size_t>(stream.index(std::ssize(content)));
        const auto length =
            std::min(static_cast<std::size_t>(1 + stream.index(k % 3 == 0 ? 1 : 40)),
                     content.size() - place);
        for (std::size_t i = 0; i < length; ++i) {
            damaged[place + i] = static_cast<char>(stream.index(256));
        }
        if (k % 4 == 0) damaged.resize(place);
        folder.write("damaged.sqlite", damaged);
        const std::string error = input_error_of([&] {
            const TrialStore store = k % 2 == 0 ? open_trial_store(path) : read_trial_store(path);
            expect_same(store.finished(simulated_series()), trials);
        });
        EXPECT_TRUE(error == "no error" || error.starts_with("damaged.sqlite: ")) << error;
        EXPECT_EQ(error.find('\n'), std::string::npos) << error;
        refused += error != "no error" ? 1 : 0;
        ASSERT_FALSE(HasFailure()) << "case " << k << " at " << place << ", " << length;
    }
    EXPECT_GT(refused, 200);
}

}  // namespace
}  // namespace posewise::io
