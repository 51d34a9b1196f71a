#include "server/store/reader_pool.h"

#include <utility>

#include "absl/cleanup/cleanup.h"

namespace ballpiston::server {

absl::Status ReaderPool::Add(const std::string& path, const std::string& vfs) {
  auto reader = Database::Open(path, Database::Mode::kReadOnly, vfs);
  if (!reader.ok()) return reader.status();
  MutexLock lock(mutex_);
  free_.push_back(*std::move(reader));
  return absl::OkStatus();
}

absl::Status ReaderPool::Read(absl::FunctionRef<absl::Status(Database&)> read) {
  std::unique_ptr<Database> reader = Take();
  if (reader == nullptr) return absl::UnavailableError("store: closed");
  const absl::Cleanup give_back = [&] {         // also if `read` throws
    reader->Execute("ROLLBACK").IgnoreError();  // SQLite may have done so already
    GiveBack(std::move(reader));
  };
  const absl::Status status = reader->Execute("BEGIN");
  return status.ok() ? read(*reader) : status;
}

std::unique_ptr<Database> ReaderPool::Take() {
  MutexLock lock(mutex_);
  while (!closed_ && free_.empty()) is_free_.Wait(mutex_);
  if (closed_) return nullptr;
  std::unique_ptr<Database> reader = std::move(free_.back());
  free_.pop_back();
  ++in_use_;
  return reader;
}

void ReaderPool::GiveBack(std::unique_ptr<Database> reader) {
  MutexLock lock(mutex_);
  free_.push_back(std::move(reader));
  --in_use_;
  is_free_.NotifyOne();
  is_back_.NotifyOne();
}

void ReaderPool::Close() {
  MutexLock lock(mutex_);
  closed_ = true;
  is_free_.NotifyAll();
  while (in_use_ > 0) is_back_.Wait(mutex_);
  free_.clear();
}

}  // namespace ballpiston::server
