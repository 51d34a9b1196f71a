// Notes that the process dies of itself: of SIGSEGV, SIGBUS, SIGFPE, SIGILL or SIGABRT.
#pragma once

#include <signal.h>

#include <memory>

namespace ballpiston::server {

// Calls `note` in the thread that receives one of these signals from this process: by a fault, by
// abort() or by raise(). A signal from another process is not noted. Then the signal has the effect
// that it had before: it ends the process. `note` must be async-signal-safe. Call this before other
// threads start.
void NoteFatalSignals(void (*note)(int signal));

// The stack on which this thread notes a signal as long as the object lives: a thread that has used
// up its own stack could not.
class SignalStack {
 public:
  SignalStack();
  ~SignalStack();
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  const std::unique_ptr<char[]> memory_;
  stack_t before_ = {};
};

}  // namespace ballpiston::server
