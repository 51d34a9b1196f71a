#include "server/store/disk_calls.h"

#include <sqlite3.h>

#include "server/observability/failpoint.h"

namespace ballpiston::server {

// SQLite has a pointer to the first member, which is also a pointer to the whole.
struct DiskCalls::Methods {
  sqlite3_io_methods watched;
  const sqlite3_io_methods* original;
  DiskCalls* calls;
  const char* failpoint;

  static const Methods& Of(const sqlite3_file& file) {
    return *reinterpret_cast<const Methods*>(file.pMethods);
  }
};

// During a call the file has its own functions again, because these may look at pMethods.
class DiskCalls::Call {
 public:
  explicit Call(sqlite3_file& file)
      : file_(file), methods_(Methods::Of(file)), mark_(*methods_.calls) {
    file.pMethods = methods_.original;
  }
  ~Call() { file_.pMethods = &methods_.watched; }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  const sqlite3_io_methods* operator->() const { return methods_.original; }

 private:
  sqlite3_file& file_;
  const Methods& methods_;
  const Mark mark_;
};

DiskCalls::DiskCalls() = default;
DiskCalls::~DiskCalls() = default;

void DiskCalls::Watch(sqlite3_file& file, const char* failpoint) {
  if (file.pMethods == nullptr) return;
  methods_.push_back(
      std::make_unique<Methods>(Methods{*file.pMethods, file.pMethods, this, failpoint}));
  sqlite3_io_methods& watched = methods_.back()->watched;
  watched.xRead = [](sqlite3_file* from, void* bytes, int count, sqlite3_int64 offset) {
    return Call(*from)->xRead(from, bytes, count, offset);
  };
  watched.xWrite = [](sqlite3_file* to, const void* bytes, int count, sqlite3_int64 offset) {
    const char* const failpoint = Methods::Of(*to).failpoint;
    if (failpoint != nullptr) Failpoint(failpoint);
    return Call(*to)->xWrite(to, bytes, count, offset);
  };
  watched.xTruncate = [](sqlite3_file* shortened, sqlite3_int64 size) {
    return Call(*shortened)->xTruncate(shortened, size);
  };
  watched.xSync = [](sqlite3_file* synced, int flags) {
    return Call(*synced)->xSync(synced, flags);
  };
  file.pMethods = &watched;
}

DiskCalls::Clock::duration DiskCalls::Waiting() const {
  const Clock::rep begin = begin_;
  if (begin == 0) return Clock::duration::zero();
  return SteadyNow() - Clock::time_point(Clock::duration(begin));
}

}  // namespace ballpiston::server
