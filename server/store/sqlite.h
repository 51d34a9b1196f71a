// SQLite connections and statements as C++ objects.
//
// A connection remembers the first error of its statements. From then on its statements have no
// effect and find no rows, until TakeStatus returns the error. So only the code that begins a
// transaction handles errors: it takes the status at the end of the transaction, and discards what
// was read if the status is not OK.
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
#include <type_traits>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"

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

class Database;

// One execution of a prepared statement; columns are numbered from 0. Times are stored in
// nanoseconds. Returns the statement to its connection when it goes out of scope.
class Query {
 public:
  Query(Database& database, sqlite3_stmt* statement) : database_(database), statement_(statement) {}

  // Binds the next parameter.
  template <typename Number>
  requires std::integral<Number> || std::is_enum_v<Number>
  void Bind(Number value) { BindInteger(static_cast<int64_t>(value)); }
  void Bind(double value);
  void Bind(absl::string_view text);
  void Bind(Blob blob);
  void Bind(absl::Time time) { BindInteger(absl::ToUnixNanos(time)); }
  void Bind(std::optional<absl::Time> time);  // empty: NULL

  // Goes to the first or the next row. False: there are no more rows, or an error.
  bool Next();

  // The value of a column: a number, an enumeration, text or a blob.
  template <typename Value>
  Value Get(int column) const {
    if constexpr (std::is_same_v<Value, std::string>) return Bytes(column);
    if constexpr (std::is_same_v<Value, double>) return Real(column);
    if constexpr (std::integral<Value> || std::is_enum_v<Value>) {
      return static_cast<Value>(Integer(column));
    }
  }

  // Sets the variables to the values of the columns, in their order.
  template <typename... Values>
  void ReadInto(Values&... values) const {
    int column = 0;
    ((values = Get<Values>(column++)), ...);
  }

 private:
  struct Reset {
    void operator()(sqlite3_stmt* statement) const;
  };

  void BindInteger(int64_t value);
  int64_t Integer(int column) const;
  double Real(int column) const;
  std::string Bytes(int column) const;

  Database& database_;
  std::unique_ptr<sqlite3_stmt, Reset> statement_;  // null: it could not be prepared
  int next_parameter_ = 1;
};

class Database {
 public:
  enum class Mode { kReadOnly, kReadWrite };

  static absl::StatusOr<std::unique_ptr<Database>> Open(const std::string& path, Mode mode);

  // Whether the file exists and is not empty.
  static bool Exists(const std::string& path);

  // Errors are not reported.
  static void RemoveFile(const std::string& path);

  ~Database();

  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // The first error since the last TakeStatus.
  const absl::Status& status() const { return status_; }
  absl::Status TakeStatus() { return std::exchange(status_, absl::OkStatus()); }
  // An error that the caller has found.
  void Fail(const absl::Status& why) { status_.Update(why); }
  // The value; or its error becomes that of the connection.
  template <typename Value>
  Value ValueOf(absl::StatusOr<Value> value) {
    Fail(value.status());
    return value.ok() ? *std::move(value) : Value();
  }

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
  void Run(const std::string& sql, const Values&... values) {
    Select(sql, values...).Next();
  }

  // The rows of a statement, each made of its one column.
  template <typename Row, typename... Values>
  std::vector<Row> All(const std::string& sql, const Values&... values) {
    std::vector<Row> rows;
    for (Query query = Select(sql, values...); query.Next();) {
      rows.push_back(query.Get<Row>(0));
    }
    return rows;
  }
  // The first of these rows; empty: there is none.
  template <typename Row, typename... Values>
  std::optional<Row> First(const std::string& sql, const Values&... values) {
    Query query = Select(sql, values...);
    return query.Next() ? std::optional(query.Get<Row>(0)) : std::nullopt;
  }
  // The first column of the first row; 0 if there is none.
  template <typename... Values>
  int64_t Integer(const std::string& sql, const Values&... values) {
    return First<int64_t>(sql, values...).value_or(0);
  }

  // Statements without parameters and rows.
  void Execute(const std::string& sql);

  // Also after an error, which it keeps. No effect without a transaction.
  void Rollback();

  // The first bytes of the file, without its log. The missing part of a short file reads as zeros.
  std::string FileStart(int bytes);

  int64_t LastInsertedRow() const;

 private:
  friend class Query;
  explicit Database(sqlite3* connection) : connection_(connection) {}

  Query Prepare(const std::string& sql);

  sqlite3* connection_;
  std::map<std::string, sqlite3_stmt*> statements_;
  absl::Status status_;
};

}  // namespace ballpiston::server
