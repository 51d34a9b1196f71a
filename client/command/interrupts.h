// Ctrl-C while a job is followed: the first press says what a second one does, a second one soon
// after cancels, and without one the program lets go of the job.
//
// Construct before any other thread is started: SIGINT stays blocked in every thread and is fetched
// by one of this class, so that all reactions run on an ordinary thread, never in a handler. While
// no reactions are set, SIGINT ends the program with exit code 130.
#ifndef BALLPISTON_CLIENT_COMMAND_INTERRUPTS_H_
#define BALLPISTON_CLIENT_COMMAND_INTERRUPTS_H_

#include <signal.h>

#include <functional>
#include <mutex>
#include <thread>

#include "absl/time/time.h"

namespace ballpiston::client {

// Each is called on the thread of Interrupts, one at a time.
struct InterruptReactions {
  std::function<void()> on_first;
  std::function<void()> on_second;
  std::function<void()> on_no_second;  // the time for a second press is over
};

class Interrupts {
 public:
  static constexpr absl::Duration kSecondPress = absl::Seconds(5);

  explicit Interrupts(absl::Duration second_press = kSecondPress);
  ~Interrupts();  // SIGINT is as before
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

  // Sets the reactions for as long as it lives; its end waits for one that is running.
  class Scope {
   public:
    Scope(Interrupts& interrupts, InterruptReactions reactions);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Interrupts& interrupts_;
    InterruptReactions reactions_;
  };

 private:
  void Listen();
  void OnSignal();
  void OnTimeout();
  int MillisecondsToTimeout();

  const absl::Duration second_press_;
  sigset_t old_mask_;
  int signals_ = -1;  // file descriptors
  int quit_ = -1;
  std::mutex mutex_;
  const InterruptReactions* reactions_ = nullptr;
  absl::Time deadline_ = absl::InfiniteFuture();  // for the second press, once there was a first
  std::thread thread_;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_INTERRUPTS_H_
