#include "server/store/reader_pool.h"

#include <utility>

#include "absl/cleanup/cleanup.h"

namespace ballpiston::server {

absl::Status ReaderPool::Add(const std::string& path) {
  auto reader = Database::Open(path, Database::Mode::kReadOnly);
  if (!reader.ok()) return reader.status();
  MutexLock lock(mutex_);
  free_.push_back(*std::move(reader));
  return absl::OkStatus();
}

absl::Status ReaderPool::Read(absl::FunctionRef<void(Database&)> read) {
  std::unique_ptr<Database> reader = Take();
  if (reader == nullptr) return absl::UnavailableError("store: closed");
  const absl::Cleanup give_back = [&] {  // also if `read` throws
    reader->Rollback();
    GiveBack(std::move(reader));
  };
  reader->Execute("BEGIN");
  read(*reader);
  return reader->TakeStatus();
}

std::unique_ptr<Database> ReaderPool::Take() {
  MutexLock lock(mutex_);
  while (!closed_ && free_.empty()) changed_.Wait(mutex_);
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
  if (closed_) return changed_.NotifyAll();
  changed_.NotifyOne();
}

void ReaderPool::Close() {
  MutexLock lock(mutex_);
  closed_ = true;
  changed_.NotifyAll();
  while (in_use_ > 0) changed_.Wait(mutex_);
  free_.clear();
}

}  // namespace ballpiston::server
