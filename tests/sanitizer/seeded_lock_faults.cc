// Faults on purpose: a member that is changed without its mutex, a function that is called without
// the mutex it requires, a function that locks the mutex and is called while the mutex is held, and
// two mutexes that are taken in the wrong order. Clang has to report them
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

class Accounts {
 public:
  void InOrder() {
    MutexLock first(first_mutex_);
    MutexLock second(second_mutex_);
  }

  void InTheOtherOrder() {
    MutexLock second(second_mutex_);
    // expected-warning@+1 {{mutex 'first_mutex_' must be acquired before 'second_mutex_'}}
    MutexLock first(first_mutex_);
  }

 private:
  Mutex first_mutex_ ABSL_ACQUIRED_BEFORE(second_mutex_);
  Mutex second_mutex_;
};

}  // namespace ballpiston::server
