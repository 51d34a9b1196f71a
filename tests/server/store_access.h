// Reads and changes a store without a server.
#pragma once

#include <string>
#include <type_traits>
#include <utility>

#include "server/store/sqlite.h"
#include "server/store/store.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {

// The value that `find` returns for an open store. `find` returns a StatusOr.
template <typename Find>
auto ReadFrom(Store& store, Find find) {
  typename std::invoke_result_t<Find, Database&>::value_type found{};
  EXPECT_OK(store.Read([&](Database& database) {
    auto result = find(database);
    if (result.ok()) found = *std::move(result);
    return result.status();
  }));
  return found;
}

// Runs `sql` on the file of a store that no server has open.
inline void ChangeStore(const std::string& path, const std::string& sql) {
  ASSERT_OK_AND_ASSIGN(const auto database, Database::Open(path, Database::Mode::kReadWrite));
  ASSERT_OK(database->Execute(sql));
}

}  // namespace ballpiston::server
