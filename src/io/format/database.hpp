#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "writer_lock.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace posewise::detail {

enum class Access { Read, Write };

/// A file of SQLite that is open. To write, it is locked for this process and made if there is
/// none; one that was made is gone again unless it is to stay. All that fails throws InputError:
/// `path: problem`.
class Database {
  public:
    Database(const std::string& path, Access access);

    const std::string& path() const { return path_; }
    void execute(const std::string& sql) const;
    /// The first column of the first row.
    Index number(const std::string& sql) const;
    std::string text(const std::string& sql) const;
    /// By the last command that writes.
    Index changed_rows() const;
    void let_stay() { new_file_.path.clear(); }
    /// Whether the file that is written is no longer what stands at its path.
    bool has_moved() const;

    /// What went wrong last, in words.
    InputError error() const;
    InputError damaged() const;
    InputError no_database() const;

  private:
    friend class Statement;
    struct Close {
        void operator()(sqlite3* database) const;
    };

    struct NewFile {
        std::string path;  ///< empty: it stays
        ~NewFile();
    };

    std::string path_;
    std::optional<WriterLock> lock_;  // the last to go
    NewFile new_file_;
    std::unique_ptr<sqlite3, Close> database_;
};

/// A command of SQL whose parameters and rows are read in order, columns counted from 0.
class Statement {
  public:
    Statement(const Database& database, const std::string& sql);

    /// The next parameter. Text must live until the last step().
    Statement& bind(Index number);
    Statement& bind(std::string_view text);
    Statement& bind_bytes(std::string_view bytes);
    /// Whether there is another row; after the last one it may be bound and run again.
    bool step();
    /// As new, its parameters unbound.
    void reset();

    Index number(int column) const;
    /// Text or bytes, until the next step().
    std::string_view text(int column) const;

  private:
    struct Finalize {
        void operator()(sqlite3_stmt* statement) const;
    };
    void check(int code) const;

    const Database* database_;
    std::unique_ptr<sqlite3_stmt, Finalize> statement_;
    int bound_ = 0;
};

/// What is written while it lives is undone at its end unless it was committed; one within another
/// is a part of that.
class Transaction {
  public:
    explicit Transaction(const Database& database);
    ~Transaction();
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;

    void commit();

  private:
    const Database* database_;
    bool is_open_ = true;
};

}  // namespace posewise::detail
