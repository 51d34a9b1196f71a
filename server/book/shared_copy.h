// A copy of a job's data at one moment, which all watches of the job share.
//
// Making a copy costs a read of the store, or the scheduler's lock. So all watches get the same
// copy as long as it is recent enough or nothing has changed. Thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <utility>

#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "server/host.h"
#include "server/mutex.h"

namespace ballpiston::server {

// `T::change` is the number of the last change before the copy was made.
template <typename T>
class SharedCopy {
 public:
  using Pointer = std::shared_ptr<const T>;

  // Returns the last copy if it has `change`, the job's last change, or if it is at most `max_age`
  // old. Otherwise makes a new copy: calls `make` with a lock held, in one thread at a time.
  absl::StatusOr<Pointer> Get(uint64_t change, std::chrono::milliseconds max_age,
                              absl::FunctionRef<absl::StatusOr<T>()> make) {
    MutexLock lock(mutex_);
    const Clock::time_point now = SteadyNow();
    const bool fits = last_ != nullptr && (last_->change >= change || now - made_ < max_age);
    if (fits) return last_;
    absl::StatusOr<T> made = make();
    if (!made.ok()) return made.status();
    last_ = std::make_shared<const T>(*std::move(made));
    made_ = now;
    return last_;
  }

  // The next Get makes a new copy.
  void Drop() {
    MutexLock lock(mutex_);
    last_ = nullptr;
  }

 private:
  using Clock = std::chrono::steady_clock;

  Mutex mutex_;
  Pointer last_ ABSL_GUARDED_BY(mutex_);
  Clock::time_point made_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ballpiston::server
