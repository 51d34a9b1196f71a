// Turns of calls that compute. Each call has a thread, so a principal with many calls would slow
// down the calls of all others and the workers. Therefore few calls compute at a time; the others
// wait. Thread-safe.
#pragma once

#include <map>
#include <string>

#include "server/mutex.h"

namespace ballpiston::server {

class Turns {
 public:
  // At most `all` calls compute at a time, and at most `of_one` of the same principal.
  Turns(int all, int of_one) : all_(all), of_one_(of_one) {}

  // Waits for a turn of the principal, and gives it back at the end of the scope.
  class Turn {
   public:
    Turn(Turns& turns, const std::string& principal);
    ~Turn();
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    Turns& turns_;
    const std::string principal_;
  };

 private:
  // Each principal has its own condition: a turn that is given back wakes one call of each.
  struct OfPrincipal {
    int taken = 0;
    int calls = 0;  // with a turn, or waiting for one
    Condition changed;
  };

  void Take(const std::string& principal);
  void GiveBack(const std::string& principal);

  const int all_, of_one_;
  Mutex mutex_;
  int taken_ ABSL_GUARDED_BY(mutex_) = 0;
  std::map<std::string, OfPrincipal> principals_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ballpiston::server
