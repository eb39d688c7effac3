#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include "core/checksum.hpp"
#include "core/text.hpp"
#include "io/campaign/trial_statement.hpp"
#include "io/format/database.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/version.hpp"
#include "posewise/io/result_files.hpp"

namespace posewise::io {
namespace {

using detail::Access;
using detail::Database;
using detail::Statement;
using detail::Transaction;

constexpr Index application = 0x706f7365;  // "pose" at byte 68 of the file
constexpr Index store_format = 1;

const std::string series_table =
    "CREATE TABLE series (id INTEGER PRIMARY KEY, statement TEXT NOT NULL UNIQUE, "
    "checksum TEXT NOT NULL)";
const std::string trials_table =
    "CREATE TABLE trials (series INTEGER NOT NULL, number INTEGER NOT NULL, "
    "\"values\" BLOB NOT NULL, checksum TEXT NOT NULL, PRIMARY KEY (series, number)) WITHOUT ROWID";

/// A series as it is in a store.
struct KeptSeries {
    TrialSeries series;
    std::string version;
    Index id = 0;
    std::string checksum;  ///< of its statement
};

/// Doubles, the lowest byte first.
std::string bytes_of(const std::vector<double>& values) {
    std::string bytes;
    bytes.reserve(8 * values.size());
    for (const double value : values) {
        const auto word = std::bit_cast<std::uint64_t>(value);
        for (int shift = 0; shift < 64; shift += 8) {
            bytes += static_cast<char>((word >> shift) & 0xffU);
        }
    }
    return bytes;
}

std::vector<double> values_of(std::string_view bytes) {
    std::vector<double> values(bytes.size() / 8);
    for (std::size_t k = 0; k < values.size(); ++k) {
        std::uint64_t word = 0;
        for (std::size_t byte = 8; byte-- > 0;) {
            word = word << 8 | static_cast<unsigned char>(bytes[8 * k + byte]);
        }
        values[k] = std::bit_cast<double>(word);
    }
    return values;
}

/// Of all that is kept of a trial, so that damage, which SQLite does not look for, is seen.
std::string checksum_of_trial(const KeptSeries& series, const Trial& trial) {
    detail::Checksum checksum;
    checksum.add(series.checksum + '/' + std::to_string(trial.number));
    checksum.add(Eigen::Map<const RowMatrixXd>(trial.values.data(), 1, std::ssize(trial.values)));
    return checksum.text();
}

/// Whether a trial found the same twice; what is not a number is that, whatever its bits.
bool is_same(const std::vector<double>& a, const std::vector<double>& b) {
    return std::ranges::equal(a, b, [](double x, double y) {
        return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y) ||
               (std::isnan(x) && std::isnan(y));
    });
}

std::string trial_name(const TrialSeries& series, const Trial& trial) {
    return "trial " + std::to_string(trial.number) + " of campaign " +
           detail::quote(series.campaign) +
           (series.variation.empty() ? "" : ", " + detail::quote(series.variation));
}

class StoreFile {
  public:
    StoreFile(const std::string& path, Access access);
    ~StoreFile();
    StoreFile(const StoreFile&) = delete;
    StoreFile& operator=(const StoreFile&) = delete;

    std::vector<TrialSeries> series() const;
    void finished(const TrialSeries& series, const VisitTrial& visitor) const;
    /// So that series are in the order in which a study has them, whichever trial is ready first.
    const KeptSeries& state(const TrialSeries& series);
    void keep(const TrialSeries& series, const Trial& trial);
    void merge(const std::vector<std::string>& from);

  private:
    void create() const;
    void check_kind() const;
    void read_series();
    void check_version() const;
    /// By increasing number.
    void visit(const KeptSeries& series, const VisitTrial& visitor) const;
    void take_all_of(const StoreFile& other);
    /// Whether a trial is kept now; not if it is kept with other values.
    bool put(const TrialSeries& series, const Trial& trial);
    bool put(const KeptSeries& series, const Trial& trial);
    KeptSeries add(const TrialSeries& series) const;

    Database database_;
    std::vector<KeptSeries> series_;  // as they were stated
    std::optional<Statement> insertion_;
};

StoreFile::StoreFile(const std::string& path, Access access) : database_(path, access) {
    if (database_.number("PRAGMA page_count") == 0) {
        // So it is for SQLite, too, if it is shorter than a page; that would be overwritten.
        std::error_code error;
        if (std::filesystem::file_size(path, error) > 0) throw database_.no_database();
        if (access == Access::Read) {
            throw input_error_at({path}, "is empty; must be a store of trials");
        }
        create();
    }
    check_kind();
    read_series();
    if (access == Access::Read) return;
    check_version();
    // With this log the writer need not wait for the disk at each trial, nor for readers.
    if (database_.text("PRAGMA journal_mode = WAL") != "wal") {
        throw input_error_at({path},
                             "cannot have a write-ahead log there; must be on a local disk");
    }
    database_.execute("PRAGMA synchronous = NORMAL");
    database_.execute("PRAGMA wal_autocheckpoint = 10000");  // pages, between waits for the disk
    insertion_.emplace(database_, "INSERT INTO trials VALUES (?, ?, ?, ?) ON CONFLICT DO NOTHING");
}

/// Without readers all goes back into one file.
StoreFile::~StoreFile() {
    if (!insertion_) return;
    insertion_.reset();
    try {
        database_.execute("PRAGMA busy_timeout = 0");
        database_.execute("PRAGMA journal_mode = DELETE");
    } catch (const InputError&) {  // the log stays beside it and is read with it
    }
}

void StoreFile::create() const {
    Transaction transaction(database_);
    database_.execute(series_table);
    database_.execute(trials_table);
    database_.execute("PRAGMA application_id = " + std::to_string(application));
    database_.execute("PRAGMA user_version = " + std::to_string(store_format));
    transaction.commit();
}

void StoreFile::check_kind() const {
    if (database_.number("PRAGMA application_id") != application) {
        throw input_error_at({database_.path()},
                             "is another program's database; must be a store of trials");
    }
    const Index format = database_.number("PRAGMA user_version");
    if (format != store_format) {
        throw input_error_at({database_.path()},
                             "is a store of format " + std::to_string(format) +
                                 ", of another version of posewise; must be of format " +
                                 std::to_string(store_format));
    }
    Statement tables(database_, "SELECT sql FROM sqlite_master WHERE sql IS NOT NULL ORDER BY sql");
    for (const std::string& table : {series_table, trials_table}) {
        if (!tables.step() || tables.text(0) != table) throw database_.damaged();
    }
    if (tables.step() || database_.text("PRAGMA integrity_check(1)") != "ok") {
        throw database_.damaged();
    }
}

void StoreFile::read_series() {
    Statement rows(database_, "SELECT statement, id, checksum FROM series ORDER BY id");
    while (rows.step()) {
        const std::string statement(rows.text(0));
        const std::string checksum = detail::checksum_of(statement);
        if (rows.text(2) != checksum) throw database_.damaged();
        const detail::StatedSeries stated =
            detail::read_trial_statement(statement, database_.path());
        series_.push_back({stated.series, stated.version, rows.number(1), checksum});
    }
    const Index is_any_lost = database_.number(
        "SELECT EXISTS (SELECT 1 FROM trials WHERE series NOT IN (SELECT id FROM series))");
    if (is_any_lost != 0) throw database_.damaged();
}

void StoreFile::check_version() const {
    for (const KeptSeries& kept : series_) {
        if (kept.version == version) continue;
        throw input_error_at({database_.path()},
                             "holds trials of posewise " + kept.version + ", and this is " +
                                 version + ", which may find other numbers; must be another file");
    }
}

std::vector<TrialSeries> StoreFile::series() const {
    std::vector<TrialSeries> all;
    for (const KeptSeries& kept : series_) all.push_back(kept.series);
    return all;
}

void StoreFile::visit(const KeptSeries& series, const VisitTrial& visitor) const {
    Statement rows(database_,
                   "SELECT number, \"values\", checksum FROM trials WHERE series = ? "
                   "ORDER BY number");
    rows.bind(series.id);
    Index least = 0;
    while (rows.step()) {
        const Trial trial{rows.number(0), values_of(rows.text(1))};
        if (trial.number < least || rows.text(2) != checksum_of_trial(series, trial)) {
            throw database_.damaged();
        }
        least = trial.number + 1;
        visitor(trial);
    }
}

void StoreFile::finished(const TrialSeries& series, const VisitTrial& visitor) const {
    const auto kept = std::ranges::find(series_, series, &KeptSeries::series);
    if (kept != series_.end()) visit(*kept, visitor);
}

const KeptSeries& StoreFile::state(const TrialSeries& series) {
    const auto kept = std::ranges::find(series_, series, &KeptSeries::series);
    if (kept != series_.end()) return *kept;
    Transaction transaction(database_);
    KeptSeries added = add(series);
    transaction.commit();
    series_.push_back(std::move(added));
    return series_.back();
}

void StoreFile::keep(const TrialSeries& series, const Trial& trial) {
    if (database_.has_moved()) {
        throw input_error_at({database_.path()}, "was moved or removed while it was written");
    }
    if (!put(series, trial)) {
        throw input_error_at({database_.path()},
                             trial_name(series, trial) +
                                 ", was found with other values before, by another machine or "
                                 "program; must be kept in another file");
    }
    database_.let_stay();
}

bool StoreFile::put(const TrialSeries& series, const Trial& trial) {
    return put(state(series), trial);
}

bool StoreFile::put(const KeptSeries& series, const Trial& trial) {
    const std::string bytes = bytes_of(trial.values);
    const std::string checksum = checksum_of_trial(series, trial);
    insertion_->bind(series.id).bind(trial.number).bind_bytes(bytes).bind(checksum).step();
    if (database_.changed_rows() == 1) return true;
    Statement row(database_, "SELECT \"values\" FROM trials WHERE series = ? AND number = ?");
    if (!row.bind(series.id).bind(trial.number).step()) throw database_.damaged();
    return is_same(values_of(row.text(0)), trial.values);
}

KeptSeries StoreFile::add(const TrialSeries& series) const {
    const std::string statement = detail::trial_statement(series, database_.path());
    const std::string checksum = detail::checksum_of(statement);
    Statement insertion(database_, "INSERT INTO series (statement, checksum) VALUES (?, ?)");
    insertion.bind(statement).bind(checksum).step();
    return {series, version, database_.number("SELECT last_insert_rowid()"), checksum};
}

void StoreFile::merge(const std::vector<std::string>& from) {
    Transaction transaction(database_);
    for (const std::string& path : from) take_all_of(StoreFile(path, Access::Read));
    transaction.commit();
    database_.let_stay();
}

void StoreFile::take_all_of(const StoreFile& other) {
    other.check_version();
    for (const KeptSeries& kept : other.series_) {
        other.visit(kept, [&](const Trial& trial) {
            if (put(kept.series, trial)) return;
            throw input_error_at({other.database_.path()},
                                 trial_name(kept.series, trial) +
                                     ", has other values than in a store before it; one of them "
                                     "must be left out");
        });
    }
}

}  // namespace

TrialStore open_trial_store(const std::string& path) {
    const auto file = std::make_shared<StoreFile>(path, Access::Write);
    return {[file](const TrialSeries& series, const VisitTrial& visitor) {
                file->state(series);
                file->finished(series, visitor);
            },
            [file](const TrialSeries& series, const Trial& trial) { file->keep(series, trial); }};
}

TrialStore read_trial_store(const std::string& path) {
    const auto file = std::make_shared<StoreFile>(path, Access::Read);
    return {[file](const TrialSeries& series, const VisitTrial& visitor) {
                file->finished(series, visitor);
            },
            [path](const TrialSeries&, const Trial&) {
                throw input_error_at({path}, "is only read; must be opened to keep trials");
            }};
}

std::vector<TrialSeries> series_in_store(const std::string& path) {
    return StoreFile(path, Access::Read).series();
}

void merge_trial_stores(const std::vector<std::string>& from, const std::string& into) {
    StoreFile(into, Access::Write).merge(from);
}

bool is_trial_store(const std::string& path) {
    constexpr std::size_t id_offset = 68;
    std::array<char, id_offset + 4> header{};
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return false;
    std::ifstream file(path, std::ios::binary);
    file.read(header.data(), std::ssize(header));
    const std::string_view bytes(header.data(), header.size());
    return file && bytes.starts_with("SQLite format 3") && bytes.substr(id_offset) == "pose";
}

}  // namespace posewise::io
