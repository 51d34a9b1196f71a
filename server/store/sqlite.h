// SQLite with owners: a connection and its statements, errors as absl::Status.
//
// UNAVAILABLE carries SQLite's own message (disk full, input/output error, ...). A connection and
// its statements belong to one thread at a time.
#ifndef BALLPISTON_SERVER_STORE_SQLITE_H_
#define BALLPISTON_SERVER_STORE_SQLITE_H_

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

struct sqlite3;
struct sqlite3_stmt;

namespace ballpiston::server {

// One execution of a prepared statement; parameters are numbered from 1, columns from 0. Returns
// the statement to its connection when it goes out of scope.
class Query {
 public:
  explicit Query(sqlite3_stmt* statement, absl::Status prepared);
  Query(Query&& other) noexcept;
  ~Query();

  Query& Bind(int64_t value);
  Query& Bind(double value);
  Query& BindText(absl::string_view value);
  Query& BindBlob(absl::string_view value);
  Query& BindNull();

  // True: there is a row. False: no (more) rows.
  absl::StatusOr<bool> Step();
  // For statements without rows.
  absl::Status Run();

  int64_t Integer(int column) const;
  double Real(int column) const;
  std::string Bytes(int column) const;  // text or blob
  bool IsNull(int column) const;

 private:
  sqlite3_stmt* statement_;
  absl::Status status_;
  int next_parameter_ = 1;
};

class Database {
 public:
  enum class Mode { kReadOnly, kReadWrite };

  static absl::StatusOr<std::unique_ptr<Database>> Open(const std::string& path, Mode mode);
  ~Database();

  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // Prepared once for each text. At most one Query of a text at a time.
  Query Prepare(const std::string& sql);

  // Statements without parameters and rows.
  absl::Status Execute(const std::string& sql);

  // The first column of the only row.
  absl::StatusOr<int64_t> Integer(const std::string& sql);
  absl::StatusOr<std::string> Text(const std::string& sql);

  int64_t LastInsertedRow() const;
  int64_t RowsChanged() const;  // by the last statement that was run

 private:
  explicit Database(sqlite3* connection) : connection_(connection) {}

  sqlite3* connection_;
  std::map<std::string, sqlite3_stmt*> statements_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_STORE_SQLITE_H_
