#include "server/store/reserve.h"

#include "absl/strings/str_cat.h"
#include "server/store/sqlite.h"

namespace ballpiston::server {

void Reserve::Take() {
  if (bytes_ == 0) return;
  const auto file = Database::Open(path_, Database::Mode::kReadWrite);
  if (file.ok()) {
    (*file)->Execute(
        absl::StrCat("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF;"
                     "CREATE TABLE IF NOT EXISTS reserve AS SELECT zeroblob(",
                     bytes_, ") AS zeros"));
  }
  // A file that is not complete, left by a crash, is an error here.
  held_ = file.ok() && (*file)->status().ok();
  if (!held_) Release();
}

void Reserve::Release() {
  held_ = false;
  Database::RemoveFile(path_);
}

}  // namespace ballpiston::server
