// Faults on purpose: a member that is changed without its mutex, a function that is called without
// the mutex it requires, and one that is called with the mutex it takes. Clang has to report them
// (scripts/thread-safety.sh).
#include "server/mutex.h"

namespace ballpiston::server {

class Counter {
 public:
  void CountOne() ABSL_LOCKS_EXCLUDED(mutex_) {
    MutexLock lock(mutex_);
    CountLocked();
  }

  void CountWithoutLock() {
    ++count_;  // expected-warning {{writing variable 'count_' requires holding mutex 'mutex_'}}
  }

  void CallWithoutLock() {
    // expected-warning@+1 {{calling function 'CountLocked' requires holding mutex 'mutex_'}}
    CountLocked();
  }

  void LockTwice() {
    MutexLock lock(mutex_);
    // expected-warning@+1 {{cannot call function 'CountOne' while mutex 'mutex_' is held}}
    CountOne();
  }

 private:
  void CountLocked() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { ++count_; }

  Mutex mutex_;
  int count_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace ballpiston::server
