// The server uses these functions of its machine: threads, clocks and random numbers. Locks are in
// mutex.h.
//
// All of it is defined in host.cc. tests/simulation links another definition, with a simulated
// machine, in which one seed determines everything.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

#include "absl/time/time.h"

namespace ballpiston::server {

std::chrono::steady_clock::time_point SteadyNow();
absl::Time WallNow();

// Processor time of the calling thread, in seconds.
double ProcessorSeconds();

uint64_t RandomBits();

// A pointer of the calling thread, null when the thread starts. Async-signal-safe.
void*& PointerOfThread();

// Works as std::thread does. The constructor throws std::system_error if the machine cannot start
// another thread.
class Thread {
 public:
  Thread();
  explicit Thread(std::function<void()> run);
  Thread(Thread&&) noexcept;
  Thread& operator=(Thread&&) noexcept;
  ~Thread();

  bool joinable() const { return running_ != nullptr; }
  void join();

 private:
  struct Running;
  std::unique_ptr<Running> running_;
};

}  // namespace ballpiston::server
