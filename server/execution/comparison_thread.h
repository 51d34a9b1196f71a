// The one thread on which methods are compared (core/method_comparison).
//
// A comparison takes a minute of one core, so it runs neither on the threads that answer calls nor
// among the workers, and there is one at a time: two would spoil each other's times. Another
// principal's waits in turn, so that nobody keeps the others from it. Thread-safe.
#ifndef BALLPISTON_SERVER_EXECUTION_COMPARISON_THREAD_H_
#define BALLPISTON_SERVER_EXECUTION_COMPARISON_THREAD_H_

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "core/method_comparison/method_comparison.h"

namespace ballpiston::server {

// ballpiston::CompareMethods, or what a test puts in its place. May throw.
using MethodComparer =
    std::function<absl::Status(const MethodComparisonSpec&, const std::stop_token&,
                               const std::function<void(const MethodMeasurement&)>& tell)>;

inline MethodComparer CoreComparer() { return &CompareMethods; }

// `tell` and `ended` are called on the thread; `ended` last, once, when the next comparison may
// already begin. One that is stopped while it waits may be told so by whoever comes next.
struct Comparison {
  std::string principal;
  MethodComparisonSpec spec;
  std::stop_source stop;  // ends it early; shared with whoever asked
  std::function<void(const MethodMeasurement&)> tell;
  std::function<void(const absl::Status&)> ended;
};

class ComparisonThread {
 public:
  enum class Admission { kBegun, kBusy, kStopped };

  explicit ComparisonThread(MethodComparer compare);
  ~ComparisonThread();  // stops

  // kBegun: now, or when those before it have ended. kBusy: the principal has one already. `ended`
  // follows if and only if it was begun.
  Admission Begin(Comparison comparison);

  // Asks comparisons in progress, and those that wait, to stop, and begins none any more.
  void AskToStop();

  // The same, and waits until it has ended. May be called more than once.
  void Stop();

 private:
  bool Has(const std::string& principal) const;  // requires the lock
  std::deque<Comparison> TakeAbandoned();        // requires the lock
  void Work();
  std::optional<Comparison> AwaitComparison();  // nothing: stopped
  absl::Status Compare(const Comparison& comparison) const;

  const MethodComparer compare_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::optional<Comparison> running_;
  std::deque<Comparison> waiting_;
  std::thread thread_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_EXECUTION_COMPARISON_THREAD_H_
