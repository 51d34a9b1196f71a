// A mutex, its lock in a scope and its condition variable, which Clang checks: a member says with
// ABSL_GUARDED_BY which mutex guards it, a function with ABSL_EXCLUSIVE_LOCKS_REQUIRED that the
// caller holds it, with ABSL_LOCKS_EXCLUDED that the function takes it, and a mutex with
// ABSL_ACQUIRED_BEFORE which other comes later. `make thread-safety` fails if the code does
// otherwise. The analysis looks at one function at a time, so it sees no order between mutexes of
// classes that call each other.
//
// absl::Mutex has these annotations too, but Debian's library of it is not instrumented: the thread
// sanitizer would not see what it orders, as it does of std::mutex.
#ifndef BALLPISTON_SERVER_MUTEX_H_
#define BALLPISTON_SERVER_MUTEX_H_

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "absl/base/thread_annotations.h"

namespace ballpiston::server {

class ABSL_LOCKABLE Mutex {
 public:
  void Lock() ABSL_EXCLUSIVE_LOCK_FUNCTION() { mutex_.lock(); }
  void Unlock() ABSL_UNLOCK_FUNCTION() { mutex_.unlock(); }

  // Tells the analysis, and does nothing. For a lambda that runs while its maker holds the mutex:
  // the analysis takes it for a function of its own.
  void AssertHeld() const ABSL_ASSERT_EXCLUSIVE_LOCK() {}

 private:
  friend class Condition;
  std::mutex mutex_;
};

class ABSL_SCOPED_LOCKABLE MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) ABSL_EXCLUSIVE_LOCK_FUNCTION(mutex) : mutex_(mutex) {
    mutex_.Lock();
  }
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;
  ~MutexLock() ABSL_UNLOCK_FUNCTION() {
    if (held_) mutex_.Unlock();
  }

  // Within the scope, by turns.
  void Unlock() ABSL_UNLOCK_FUNCTION() {
    held_ = false;
    mutex_.Unlock();
  }
  void Lock() ABSL_EXCLUSIVE_LOCK_FUNCTION() {
    mutex_.Lock();
    held_ = true;
  }

 private:
  Mutex& mutex_;
  bool held_ = true;
};

// Wakes without cause too, so a wait belongs into a loop. There are no predicates, because the
// analysis would not know that they run with the mutex held.
class Condition {
 public:
  void Wait(Mutex& mutex) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex) {
    std::unique_lock lock(mutex.mutex_, std::adopt_lock);
    condition_.wait(lock);
    lock.release();
  }

  // False: it is `end` or later.
  bool WaitUntil(Mutex& mutex, std::chrono::steady_clock::time_point end)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex) {
    std::unique_lock lock(mutex.mutex_, std::adopt_lock);
    const std::cv_status status = condition_.wait_until(lock, end);
    lock.release();
    return status == std::cv_status::no_timeout;
  }

  void NotifyOne() { condition_.notify_one(); }
  void NotifyAll() { condition_.notify_all(); }

 private:
  std::condition_variable condition_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_MUTEX_H_
