// A simulated machine: its own time, and threads of which one runs at a time. One seed determines
// which thread runs next, and therefore everything.
//
// machine.cc defines what server/host.h and server/mutex.h declare, in place of server/host.cc. A
// thread runs until it waits: for a lock, a condition, a time, or another thread. Before it takes a
// lock another thread may run. Time passes only while all threads wait.
#pragma once

#include <semaphore>

#include "tests/support/dice.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

class Machine : public Dice {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Machine(uint64_t seed);
  ~Machine();
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  // Returns when `main` and all threads that it started have ended. Throws std::runtime_error if
  // all threads wait, and no wait has a time limit. Outside of Run the locks are those of the
  // system.
  void Run(std::function<void()> main);

  // ---- for the threads ----

  struct SimulatedThread;

  SimulatedThread* Start(std::function<void()> run);
  // False: the time `until` has come, and the thread goes on.
  bool Join(SimulatedThread* thread, Clock::time_point until = Clock::time_point::max());
  // Ends Run, whatever the other threads do. They never run again.
  void GiveUp();
  void Yield() { Switch(); }
  void Sleep(Clock::duration time) { Await(nullptr, now_ + time); }
  // Waits for a notification with the same `what`; only the address is compared. False: the time
  // `until` has come.
  bool Await(const void* what, std::optional<Clock::time_point> until = std::nullopt);
  bool NotifyOne(const void* what);  // false: none waited
  void NotifyAll(const void* what);

  Clock::time_point now() const { return now_; }

  // A random time up to `most`. Short times are more frequent.
  Clock::duration UpTo(Clock::duration most) {
    const double share = Uniform();
    return Clock::duration(static_cast<Clock::rep>(share * share * double(most.count())));
  }

  uint64_t switches() const { return switches_; }  // from thread to thread

 private:
  void Switch();  // to a thread that is ready, or back to Run if all have ended
  SimulatedThread* Choose();
  bool PassTime();

  Clock::time_point now_;
  uint64_t switches_ = 0;
  std::vector<std::unique_ptr<SimulatedThread>> threads_;
  SimulatedThread* running_ = nullptr;
  std::binary_semaphore outside_{0};  // the turn of Run
  bool is_stuck_ = false;
};

}  // namespace ballpiston::server
