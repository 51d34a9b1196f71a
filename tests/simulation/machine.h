// A simulated machine: its own time, and threads that run one at a time, all within one thread of
// the system. One seed determines which thread runs next, and therefore everything.
//
// machine.cc defines what server/host.h and server/mutex.h declare, in place of server/host.cc. A
// thread runs until it waits: for a lock, a condition, a time, or another thread. Before it takes a
// lock another thread may run. Time passes only while all threads wait.
#pragma once

#include <ucontext.h>

#include "tests/support/preamble.h"

namespace ballpiston::server {

class Machine {
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

  struct Fiber;  // a thread

  Fiber* Start(std::function<void()> run);
  // False: the time `until` has come, and the thread goes on.
  bool Join(Fiber* fiber, Clock::time_point until = Clock::time_point::max());
  // Ends Run, whatever the other threads do. They never run again.
  void GiveUp();
  void Yield() { Switch(); }
  void Sleep(Clock::duration time) { Await(nullptr, now_ + time); }
  // Waits for a notification with the same `what`; only the address is compared. False: the time
  // `until` has come.
  bool Await(const void* what, std::optional<Clock::time_point> until = std::nullopt);
  void NotifyOne(const void* what);
  void NotifyAll(const void* what);

  Clock::time_point now() const { return now_; }
  void*& pointer_of_thread();

  // ---- chance ----

  uint64_t Bits() { return random_(); }
  uint64_t Below(uint64_t end) { return random_() % end; }
  double Uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }  // from [0, 1)
  bool Chance(double probability) { return Uniform() < probability; }
  // A random time up to `most`. Short times are more frequent.
  Clock::duration UpTo(Clock::duration most) {
    const double share = Uniform();
    return Clock::duration(static_cast<Clock::rep>(share * share * double(most.count())));
  }

  uint64_t switches() const { return switches_; }  // from thread to thread

 private:
  static void Enter();
  void Switch();  // to a thread that is ready, or back to Run if all have ended
  Fiber* Choose();
  bool PassTime();

  std::mt19937_64 random_;
  Clock::time_point now_;
  uint64_t switches_ = 0;
  std::vector<std::unique_ptr<Fiber>> fibers_;
  Fiber* running_ = nullptr;
  ucontext_t outside_ = {};
  bool is_stuck_ = false;
};

}  // namespace ballpiston::server
