// Reads and changes a store without a server.
#pragma once

#include <type_traits>

#include "server/store/job_name.h"
#include "server/store/job_table.h"
#include "server/store/sqlite.h"
#include "server/store/store.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

// What `find` returns for an open store.
template <typename Find>
auto ReadFrom(Store& store, Find find) {
  auto found = store.Read(find);
  EXPECT_OK(found);
  return found.value_or(std::invoke_result_t<Find, Database&>());
}

// Runs `sql` on the file of a store that no server has open.
inline void ChangeStore(const std::string& path, const std::string& sql) {
  ASSERT_OK_AND_ASSIGN(const auto database, Database::Open(path, Database::Mode::kReadWrite));
  database->Execute(sql);
  ASSERT_OK(database->status());
}

// Changes a job in the file of a store that no server has open.
inline void ChangeJob(const std::string& path, const std::string& name,
                      const std::function<void(v1::EnsembleJob& job)>& change) {
  ASSERT_OK_AND_ASSIGN(const auto store, Store::Open(path, {.stall = kUnreachedLimit}));
  ASSERT_OK(store->Commit([&](Database& database) {
    std::optional<JobRecord> record = FindJob(database, *JobIdOf(name), Grid::kIncluded);
    change(record.value().job);
    UpdateJob(database, *record);
  }));
}

}  // namespace ballpiston::server
