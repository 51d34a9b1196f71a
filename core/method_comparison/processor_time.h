// Processor time of the calling thread, in seconds: what other threads and programs do meanwhile
// does not count.
#ifndef BALLPISTON_CORE_METHOD_COMPARISON_PROCESSOR_TIME_H_
#define BALLPISTON_CORE_METHOD_COMPARISON_PROCESSOR_TIME_H_

#include <ctime>

namespace ballpiston {

inline double ThreadSeconds() {
  timespec time = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// What one call of `run` costs: the mean over as many as take 2 ms, of which reading the clock is
// one part in a thousand.
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

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_METHOD_COMPARISON_PROCESSOR_TIME_H_
