// A fault on purpose: two mutexes are taken in the wrong order. Clang has to report it
// (scripts/thread-safety.sh).
#include "server/mutex.h"

namespace ballpiston::server {

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
