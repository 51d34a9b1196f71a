#include "server/store/reserve.h"

#include <sqlite3.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "absl/cleanup/cleanup.h"

namespace ballpiston::server {
namespace {

constexpr size_t kPieceBytes = size_t{64} << 10;

int Open(sqlite3_vfs& files, const char* path, sqlite3_file& file, DiskCalls& calls) {
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_SUPER_JOURNAL;
  const DiskCalls::Mark mark(calls);
  return files.xOpen(&files, path, &file, flags, nullptr);
}

bool WriteZeros(sqlite3_vfs& files, const std::string& path, size_t bytes, DiskCalls& calls) {
  // SQLite reads the path again later, and needs two zeros at its end.
  const std::string name = path + std::string(2, '\0');
  const auto memory = std::make_unique<std::max_align_t[]>(
      static_cast<size_t>(files.szOsFile) / sizeof(std::max_align_t) + 1);
  sqlite3_file& file = *reinterpret_cast<sqlite3_file*>(memory.get());
  if (Open(files, name.c_str(), file, calls) != SQLITE_OK) return false;
  const absl::Cleanup close = [&] { file.pMethods->xClose(&file); };
  sqlite3_int64 present = 0;
  file.pMethods->xFileSize(&file, &present);
  if (present >= static_cast<sqlite3_int64>(bytes)) return true;  // an earlier process wrote it
  const std::vector<char> zeros(std::min(bytes, kPieceBytes), '\0');
  for (size_t written = 0; written < bytes; written += zeros.size()) {
    const int count = static_cast<int>(std::min(zeros.size(), bytes - written));
    const auto offset = static_cast<sqlite3_int64>(written);
    const DiskCalls::Mark mark(calls);
    if (file.pMethods->xWrite(&file, zeros.data(), count, offset) != SQLITE_OK) return false;
  }
  return true;
}

}  // namespace

Reserve::Reserve(const std::string& store, size_t bytes, std::string vfs, DiskCalls& calls)
    : path_(store + "-reserve"), bytes_(bytes), vfs_(std::move(vfs)), calls_(calls) {}

void Reserve::Take() {
  sqlite3_vfs* const files = sqlite3_vfs_find(vfs_.empty() ? nullptr : vfs_.c_str());
  if (bytes_ == 0 || files == nullptr) return;
  held_ = WriteZeros(*files, path_, bytes_, calls_);
  if (!held_) Release();
}

void Reserve::Release() {
  sqlite3_vfs* const files = sqlite3_vfs_find(vfs_.empty() ? nullptr : vfs_.c_str());
  held_ = false;
  if (files == nullptr) return;
  const DiskCalls::Mark mark(calls_);
  files->xDelete(files, path_.c_str(), 0);
}

}  // namespace ballpiston::server
