#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "../../src/core/checksum.hpp"
#include "../../src/io/campaign/trial_statement.hpp"
#include "../../src/io/format/atomic_file.hpp"
#include "posewise/core/version.hpp"
#include "posewise/io/result_files.hpp"
#include "trials.hpp"

namespace posewise::io {
namespace {

using detail::read_file;
using namespace testing;

TrialSeries measured_series() {
    TrialSeries series;
    series.campaign = "arm";
    series.checksum = "fnv1a64:0";
    series.pose_counts = {5};
    series.splits = 4;
    series.ids = {"1", "2", "\xc3\xa9\n"};
    return series;
}

/// Runs SQL as other programs do.
void run_sql(const std::string& path, const std::string& sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(::sqlite3_open(path.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(::sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << ::sqlite3_errmsg(database);
    ::sqlite3_close(database);
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
        expect_same(finished(store, simulated_series()), trials);
    }
    EXPECT_EQ(folder.file_count(), 1U);  // no log, no lock
    expect_same(finished(open_trial_store(path), simulated_series()), trials);
    expect_same(finished(read_trial_store(path), simulated_series()), trials);
}

TEST(TrialStore, GivesBackTheUnitOfErrors) {
    const TemporaryFolder folder;
    const std::string path = folder.path("a.sqlite");
    TrialSeries series = measured_series();
    series.units = &pixel_units;
    {
        const TrialStore store = open_trial_store(path);
        store.keep(series, {0, {1, 2}});
        store.keep(measured_series(), {0, {3}});
    }
    const std::vector<TrialSeries> kept = series_in_store(path);
    ASSERT_EQ(kept.size(), 2U);
    EXPECT_EQ(kept[0].units, &pixel_units);
    EXPECT_EQ(kept[1].units, &length_units);
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
        expect_same(finished(store, all[k]), {{0, {static_cast<double>(k)}}});
    }
    EXPECT_TRUE(finished(store, simulated_series("x=2")).empty());
    all.push_back(simulated_series("x=2"));  // asked for, and in its place from then on
    EXPECT_EQ(series_in_store(path), all);
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
    expect_same(finished(store, simulated_series("x=1")), {{17, {1, nan}}});
}

TEST(TrialStore, LeavesNoFileWithoutTrials) {
    const TemporaryFolder folder;
    open_trial_store(folder.path("a.sqlite"));
    EXPECT_EQ(folder.file_count(), 0U);
    const std::string empty = folder.write("empty.sqlite", "");
    EXPECT_EQ(input_error_of([&] { read_trial_store(empty); }),
              "empty.sqlite: is empty; must be a store of trials");
    store_of(folder, "empty.sqlite", 0, 1);
    EXPECT_EQ(finished(read_trial_store(empty), simulated_series()).size(), 1U);
}

TEST(TrialStore, RefusesTextThatNoOneCouldRead) {
    const TemporaryFolder folder;
    TrialSeries series = simulated_series("\xff");
    const TrialStore store = open_trial_store(folder.path("a.sqlite"));
    EXPECT_NE(input_error_of([&] { store.keep(series, drawn_trial(0)); }).find("UTF-8"),
              std::string::npos);
    store.keep(simulated_series(), drawn_trial(0));
    EXPECT_EQ(finished(store, simulated_series()).size(), 1U);
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
        expect_same(finished(read_trial_store(into), one),
                    finished(read_trial_store(folder.path("new.sqlite")), one));
    }
    EXPECT_EQ(finished(read_trial_store(into), simulated_series()).size(), 70U);
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
        expect_same(finished(read_trial_store(into), simulated_series()), {drawn_trial(50)});
    }
    EXPECT_EQ(input_error_of([&] { merge_trial_stores({folder.path("none.sqlite")}, into); }),
              "none.sqlite: cannot be read: No such file or directory");
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
    std::filesystem::create_symlink("loop", folder.path("loop"));
    EXPECT_EQ(opening_error(folder.path("loop")),
              "loop: cannot be read: Too many levels of symbolic links");
    std::filesystem::remove(folder.path("loop"));
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
    for (const std::string sql :
         {"CREATE TABLE other (a)", "DROP TABLE trials", "UPDATE trials SET series = 99",
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
    expect_same(finished(read_trial_store(path), simulated_series()), {drawn_trial(0)});
    EXPECT_THROW(merge_trial_stores({path}, folder.path("b.sqlite")), InputError);
    EXPECT_EQ(folder.file_count(), 1U);
}

}  // namespace
}  // namespace posewise::io
