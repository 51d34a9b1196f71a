// Processor time of the calling thread, in seconds. It does not include the time of other threads
// and programs.
#pragma once

#include <ctime>

namespace ballpiston::server {

inline double ThreadSeconds() {
  timespec time = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// The cost of one call of `run`: the mean over calls that take 2 ms together. Reading the clock
// takes a thousandth of this time.
template <typename Run>
double SecondsOf(const Run& run) {
  constexpr double kEnough = 2e-3;
  const double begin = ThreadSeconds();
  for (double repeats = 1, next = 1;; ++repeats) {
    run();
    if (repeats < next) continue;  // the clock is read after 1, 2, 4, 8, ... calls
    const double elapsed = ThreadSeconds() - begin;
    if (elapsed >= kEnough) return elapsed / repeats;
    next *= 2;
  }
}

}  // namespace ballpiston::server
