// A mutex, its lock in a scope and its condition variable. Clang checks their use:
//
//   ABSL_GUARDED_BY                which mutex guards a member
//   ABSL_EXCLUSIVE_LOCKS_REQUIRED  the caller of a function has to hold the mutex
//   ABSL_LOCKS_EXCLUDED            the function takes the mutex; its caller must not hold it
//   ABSL_ACQUIRED_BEFORE           which other mutex is taken later
//
// `make thread-safety` fails if the code breaks these rules. The analysis looks at one function at
// a time, so it cannot check the order between mutexes of classes that call each other.
//
// absl::Mutex has these annotations too. But Debian's build of absl::Mutex is not instrumented, so
// the thread sanitizer would not see its synchronisation. It sees that of std::mutex.
//
// The functions are in host.cc.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "absl/base/thread_annotations.h"

namespace ballpiston::server {

class ABSL_LOCKABLE Mutex {
 public:
  void Lock() ABSL_EXCLUSIVE_LOCK_FUNCTION();
  void Unlock() ABSL_UNLOCK_FUNCTION();

  // Tells the analysis that the mutex is held, and does nothing. For a lambda that runs while its
  // creator holds the mutex: the analysis treats the lambda as a function of its own.
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
  ~MutexLock() ABSL_UNLOCK_FUNCTION() { mutex_.Unlock(); }

 private:
  Mutex& mutex_;
};

// A wait may end without a notification, so it belongs in a loop. There are no predicates, because
// the analysis would not know that they run with the mutex held.
class Condition {
 public:
  void Wait(Mutex& mutex) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex);

  // False: the time `end` has come.
  bool WaitUntil(Mutex& mutex, std::chrono::steady_clock::time_point end)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex);

  void NotifyOne();
  void NotifyAll();

 private:
  std::condition_variable condition_;
};

}  // namespace ballpiston::server
