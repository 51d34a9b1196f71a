// SQLite connections and statements as C++ objects, with errors as absl::Status.
//
// A status has SQLite's own message. Its code tells what failed.
// The disk, so a retry may succeed (IsOfTheDisk):
//   RESOURCE_EXHAUSTED  the disk or the user's quota is full
//   UNAVAILABLE         input/output error, cannot open, locked, out of memory, ...
// The file, so a retry fails too:
//   DATA_LOSS           the file is damaged, or not a database
// The statement or a value that was bound to it, so it can never succeed:
//   INVALID_ARGUMENT    a constraint, a type, a value too big
//   INTERNAL            anything else
// A connection and its statements belong to one thread at a time.
#pragma once

#include <concepts>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

struct sqlite3;
struct sqlite3_stmt;

namespace ballpiston::server {

// Whether the disk caused the error. False for every status with a payload: the project's code made
// such a status.
bool IsOfTheDisk(const absl::Status& status);

// A value of a column of the type BLOB. The bytes must live until it is bound.
struct Blob {
  absl::string_view bytes;
};

// One execution of a prepared statement; columns are numbered from 0. Returns the statement to its
// connection when it goes out of scope.
class Query {
 public:
  explicit Query(sqlite3_stmt* statement, absl::Status prepared);
  Query(Query&& other) noexcept;
  ~Query();

  // Binds the next parameter.
  template <std::integral Number>
  void Bind(Number value) {
    BindInteger(static_cast<int64_t>(value));
  }
  void Bind(double value);
  void Bind(absl::string_view text);
  void Bind(Blob blob);

  // True: there is a row. False: no (more) rows.
  absl::StatusOr<bool> Step();
  // Calls `on_row` for each row, until it returns false.
  absl::Status ForEach(absl::FunctionRef<bool(const Query& row)> on_row);

  int64_t Integer(int column) const;
  double Real(int column) const;
  std::string Bytes(int column) const;  // text or blob
  bool IsNull(int column) const;

 private:
  void BindInteger(int64_t value);

  sqlite3_stmt* statement_;
  absl::Status status_;
  int next_parameter_ = 1;
};

class Database {
 public:
  enum class Mode { kReadOnly, kReadWrite };

  // `vfs` names one of SQLite's file systems; empty: that of the operating system.
  static absl::StatusOr<std::unique_ptr<Database>> Open(const std::string& path, Mode mode,
                                                        const std::string& vfs = std::string());

  // Whether the file exists and is not empty.
  static bool Exists(const std::string& path, const std::string& vfs = std::string());

  // Errors are not reported.
  static void RemoveFile(const std::string& path, const std::string& vfs);

  ~Database();

  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // A statement with its parameters. It is prepared once for each text. At most one Query of a text
  // at a time.
  template <typename... Values>
  Query Select(const std::string& sql, const Values&... values) {
    Query query = Prepare(sql);
    (query.Bind(values), ...);
    return query;
  }

  // A statement without rows.
  template <typename... Values>
  absl::Status Run(const std::string& sql, const Values&... values) {
    return Select(sql, values...).Step().status();
  }

  // The first column of the first row; 0 if there is none.
  template <typename... Values>
  absl::StatusOr<int64_t> Integer(const std::string& sql, const Values&... values) {
    return OnlyInteger(Select(sql, values...));
  }
  absl::StatusOr<std::string> Text(const std::string& sql);

  // Statements without parameters and rows.
  absl::Status Execute(const std::string& sql);

  // The size of the file on disk, without its log.
  absl::StatusOr<int64_t> FileBytes() const;
  absl::StatusOr<std::string> FileStart(int bytes) const;

  // Writes a copy of this database, as it is at one moment, to an empty or missing file. The copy
  // is not in WAL mode and has no free pages.
  absl::Status CopyTo(const std::string& path);

  // False also after an error for which SQLite has rolled the transaction back.
  bool InTransaction() const;

  int64_t LastInsertedRow() const;
  int64_t RowsChanged() const;  // by the last statement that was run

 private:
  explicit Database(sqlite3* connection) : connection_(connection) {}

  Query Prepare(const std::string& sql);
  static absl::StatusOr<int64_t> OnlyInteger(Query query);

  sqlite3* connection_;
  std::map<std::string, sqlite3_stmt*> statements_;
};

}  // namespace ballpiston::server
