#include "database.hpp"

#include <sqlite3.h>

#include <cstring>
#include <filesystem>

#include "core/text.hpp"

namespace posewise::detail {
namespace {

constexpr int busy_wait_ms = 10000;

/// Refuses folders, devices and pipes. The whole path, the file's own and not a link's; SQLite
/// takes some short ones (":memory:") for no files.
std::string database_file(const std::string& path, Access access) {
    namespace fs = std::filesystem;
    if (path.empty()) throw InputError("the name of a store of trials is empty; must be a file");
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::status_known(status)) {
        throw input_error_at({path}, "cannot be read: " + error.message());
    }
    if (fs::is_directory(status)) {
        throw input_error_at({path}, "is a directory; must be the name of a file");
    }
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        throw input_error_at({path}, "is a device or pipe; must be a file");
    }
    if (access == Access::Read && !fs::exists(status)) {
        throw input_error_at({path}, "cannot be read: " + error.message());
    }
    const fs::path whole = fs::absolute(path);
    const fs::path own = fs::weakly_canonical(whole, error);
    return (error ? whole : own).string();
}

}  // namespace

Database::NewFile::~NewFile() {
    std::error_code ignored;
    if (!path.empty()) std::filesystem::remove(path, ignored);
}

void Database::Close::operator()(sqlite3* database) const { ::sqlite3_close_v2(database); }

Database::Database(const std::string& path, Access access) : path_(path) {
    const std::string file = database_file(path, access);
    int flags = SQLITE_OPEN_READONLY;
    if (access == Access::Write) {
        flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
        lock_.emplace(file, path);
        if (!std::filesystem::exists(file)) new_file_.path = file;
    }
    sqlite3* opened = nullptr;
    const int code = ::sqlite3_open_v2(file.c_str(), &opened, flags, nullptr);
    database_.reset(opened);
    if (opened == nullptr) throw std::bad_alloc();
    if (code != SQLITE_OK) throw error();
    ::sqlite3_extended_result_codes(opened, 1);
    ::sqlite3_busy_timeout(opened, busy_wait_ms);
    if (access == Access::Write && ::sqlite3_db_readonly(opened, "main") != 0) {
        throw input_error_at({path}, "must not be written; must be writable, as must its folder");
    }
    // What a damaged file, or one made to do harm, has among its tables is not run.
    ::sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    ::sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    ::sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
    ::sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    execute("PRAGMA cell_size_check = ON");
}

void Database::execute(const std::string& sql) const {
    Statement statement(*this, sql);
    while (statement.step()) continue;
}

Index Database::number(const std::string& sql) const {
    Statement statement(*this, sql);
    if (!statement.step()) throw damaged();
    return statement.number(0);
}

std::string Database::text(const std::string& sql) const {
    Statement statement(*this, sql);
    if (!statement.step()) throw damaged();
    return std::string(statement.text(0));
}

Index Database::changed_rows() const { return ::sqlite3_changes(database_.get()); }

bool Database::has_moved() const {
    int moved = 0;
    ::sqlite3_file_control(database_.get(), "main", SQLITE_FCNTL_HAS_MOVED, &moved);
    return moved != 0;
}

InputError Database::damaged() const {
    return input_error_at({path_}, "is damaged; must be a store of trials as it was written");
}

InputError Database::no_database() const {
    return input_error_at({path_}, "is no store of trials, or damaged from its beginning");
}

InputError Database::error() const {
    const std::string reason = ::sqlite3_errmsg(database_.get());
    const int system_error = ::sqlite3_system_errno(database_.get());
    const std::string cause = system_error != 0 ? std::strerror(system_error) : reason;
    switch (::sqlite3_extended_errcode(database_.get()) & 0xff) {
        case SQLITE_CORRUPT:
            return damaged();
        case SQLITE_NOTADB:
            return no_database();
        case SQLITE_FULL:
            return input_error_at({path_}, "cannot be written, the disk is full; must have room");
        case SQLITE_READONLY:
            return input_error_at({path_}, "must not be written (" + reason +
                                               "); must be writable, as must its folder");
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            return input_error_at({path_}, "is locked by another program; that must end first");
        case SQLITE_CANTOPEN:
            return input_error_at({path_}, "cannot be opened: " + cause);
        case SQLITE_IOERR:
            return input_error_at({path_}, "cannot be read or written: " + cause);
        default:
            return input_error_at({path_}, "cannot be used: " + reason);
    }
}

void Statement::Finalize::operator()(sqlite3_stmt* statement) const {
    ::sqlite3_finalize(statement);
}

Statement::Statement(const Database& database, const std::string& sql) : database_(&database) {
    sqlite3_stmt* prepared = nullptr;
    const int code =
        ::sqlite3_prepare_v2(database.database_.get(), sql.c_str(), -1, &prepared, nullptr);
    statement_.reset(prepared);
    check(code);
}

void Statement::check(int code) const {
    if (code != SQLITE_OK) throw database_->error();
}

Statement& Statement::bind(Index number) {
    check(::sqlite3_bind_int64(statement_.get(), ++bound_, number));
    return *this;
}

Statement& Statement::bind(std::string_view text) {
    check(::sqlite3_bind_text64(statement_.get(), ++bound_, text.data(), text.size(), SQLITE_STATIC,
                                SQLITE_UTF8));
    return *this;
}

Statement& Statement::bind_bytes(std::string_view bytes) {
    check(::sqlite3_bind_blob64(statement_.get(), ++bound_, bytes.data(), bytes.size(),
                                SQLITE_STATIC));
    return *this;
}

bool Statement::step() {
    const int code = ::sqlite3_step(statement_.get());
    if (code == SQLITE_ROW) return true;
    if (code != SQLITE_DONE) {
        const InputError problem = database_->error();
        reset();
        throw problem;
    }
    reset();
    return false;
}

void Statement::reset() {
    ::sqlite3_reset(statement_.get());
    ::sqlite3_clear_bindings(statement_.get());
    bound_ = 0;
}

Index Statement::number(int column) const {
    if (::sqlite3_column_type(statement_.get(), column) != SQLITE_INTEGER) {
        throw database_->damaged();
    }
    return ::sqlite3_column_int64(statement_.get(), column);
}

std::string_view Statement::text(int column) const {
    const int type = ::sqlite3_column_type(statement_.get(), column);
    if (type != SQLITE_TEXT && type != SQLITE_BLOB) throw database_->damaged();
    const void* const data = ::sqlite3_column_blob(statement_.get(), column);
    const int size = ::sqlite3_column_bytes(statement_.get(), column);
    return {size > 0 ? static_cast<const char*>(data) : "", static_cast<std::size_t>(size)};
}

Transaction::Transaction(const Database& database) : database_(&database) {
    database.execute("SAVEPOINT posewise");
}

Transaction::~Transaction() {
    if (!is_open_) return;
    try {
        database_->execute("ROLLBACK TO posewise");
        database_->execute("RELEASE posewise");
    } catch (const InputError&) {  // it undid all itself, as on a full disk
    }
}

void Transaction::commit() {
    database_->execute("RELEASE posewise");
    is_open_ = false;
}

}  // namespace posewise::detail
