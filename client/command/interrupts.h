// Ctrl-C, SIGTERM and a closed terminal (SIGHUP): each ends the program at once with exit code 130.
#pragma once

#include <sys/types.h>

#include <functional>

#include "absl/status/statusor.h"
#include "client/library/child_process.h"

namespace ballpiston::client {

// Call this once, before any other thread starts. The signals are then blocked in every thread, and
// a thread of their own receives them until the program ends. Therefore an ordinary thread prints
// the last message, not a signal handler. A signal that was ignored before (nohup) stays ignored.
// A signal that comes while main returns may be too late: the exit code is then that of main.
void ListenForInterrupts();

// If the program is interrupted while this object exists, `farewell` runs first, for 0.15 s at
// most. The destructor waits for a running `farewell`. The objects can be nested: only the
// innermost `farewell` runs. Has no effect without ListenForInterrupts.
class OnInterrupt {
 public:
  explicit OnInterrupt(std::function<void()> farewell);
  ~OnInterrupt();
  OnInterrupt(const OnInterrupt&) = delete;
  OnInterrupt& operator=(const OnInterrupt&) = delete;

 private:
  const std::function<void()> farewell_;
  const std::function<void()>* outer_;
};

// Starts the child and waits for its end, as RunChild does. If the program is interrupted
// meanwhile, `stop` gets the child's id.
absl::StatusOr<int> RunInterruptible(const ChildProcess& child,
                                     const std::function<void(pid_t)>& stop);

}  // namespace ballpiston::client
