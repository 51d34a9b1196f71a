// Ctrl-C, SIGTERM and a closed terminal (SIGHUP): each ends the program at once with exit code 130.
//
// Construct it before any other thread starts. The signals are blocked in every thread, and a
// thread of this class receives them. Therefore an ordinary thread prints the last message, not a
// signal handler. A signal that was ignored before (nohup) stays ignored.
#pragma once

#include <signal.h>

#include <functional>
#include <mutex>
#include <thread>

#include "absl/status/statusor.h"
#include "client/library/child_process.h"

namespace ballpiston::client {

class Interrupts {
 public:
  Interrupts();
  ~Interrupts();  // restores the signals
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

  // If the program is interrupted while a Scope exists, `farewell` runs first, for 0.15 s at most.
  // The destructor waits for a running `farewell`. Scopes can be nested: only the innermost
  // `farewell` runs. If `interrupts` is null, the Scope does nothing.
  class Scope {
   public:
    Scope(Interrupts* interrupts, std::function<void()> farewell);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Interrupts* const interrupts_;
    const std::function<void()> farewell_;
    const std::function<void()>* outer_ = nullptr;
  };

 private:
  void Listen();

  sigset_t signals_, old_mask_;
  int signal_file_ = -1, quit_file_ = -1;
  std::mutex mutex_;
  const std::function<void()>* farewell_ = nullptr;
  std::thread thread_;
};

// Starts the child and waits for its end, as RunChild does. If the program is interrupted
// meanwhile, `stop` gets the child's id.
absl::StatusOr<int> RunInterruptible(const ChildProcess& child, Interrupts* interrupts,
                                     const std::function<void(pid_t)>& stop);

}  // namespace ballpiston::client
