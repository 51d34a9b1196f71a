#include "tools/stability/pair_methods.h"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <ctime>
#include <limits>
#include <mutex>
#include <thread>
#include <utility>

#include "core/billiard/reference_flow.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/flows/precise_flow.h"
#include "tools/flows/rounded_to.h"
#include "tools/stability/event_methods.h"
#include "tools/stability/fixed_step_events.h"
#include "tools/stability/pair_watch.h"
#include "tools/stability/textbook_flow.h"

namespace ballpiston::stability {
namespace {

// The limit for a batch of orbits, in seconds of processor time per collision. An orbit that takes
// longer has lost its piston: a batch of orbits that are aimed at the piston takes milliseconds.
constexpr double kPatience = 10;

// Ends the endless orbits of the thread that made it. It measures this thread's processor time, so
// that other work of the machine does not count. If no collision is missed, it has no effect.
class Watchdog {
 public:
  explicit Watchdog(double patience) {
    pthread_getcpuclockid(pthread_self(), &clock_);
    deadline_ = SecondsSpent() + patience;
    thread_ = std::jthread([this](const std::stop_token& done) { Watch(done); });
  }

  std::stop_token token() const { return orbits_.get_token(); }

 private:
  void Watch(const std::stop_token& done) {
    constexpr std::chrono::milliseconds kBetweenLooks(100);
    std::unique_lock lock(mutex_);
    while (!done.stop_requested() && SecondsSpent() < deadline_) {
      woken_.wait_for(lock, done, kBetweenLooks, [] { return false; });
    }
    if (!done.stop_requested()) orbits_.request_stop();
  }

  double SecondsSpent() const {
    timespec time = {};
    clock_gettime(clock_, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  double deadline_ = 0;
  clockid_t clock_ = CLOCK_THREAD_CPUTIME_ID;
  std::stop_source orbits_;
  std::mutex mutex_;
  std::condition_variable_any woken_;
  std::jthread thread_;
};

template <Engine engine, typename Real>
Failures RunByEngine(const PairGeometry& geometry, std::span<const PairState> starts,
                     uint64_t collisions) {
  CollisionWatch watch(geometry, std::numeric_limits<Real>::epsilon(), starts, collisions);
  const Watchdog watchdog(kPatience * static_cast<double>(collisions));
  RunOrbits(engine, geometry, starts.size(), watch, watchdog.token());
  return watch.Finish();
}

template <typename Flow>
void RunWatched(const PairGeometry& geometry, const PairState& start, uint64_t collisions,
                Failures& failures) {
  // While a ball of speed 3e-9 crosses the cell, the piston passes about 1e9 times.
  constexpr uint64_t kMostEvents = 10'000'000'000;
  Flow flow(geometry, RoundedTo<RealOf<Flow>>(start));
  PairWatch watch(geometry, kEpsilon<Flow>);
  ++failures.orbits;
  for (uint64_t events = 0; collisions > 0; ++events) {
    if (events == kMostEvents) {
      ++failures.missed;
      return;
    }
    const auto event = flow.Step();
    if (!watch.See(RoundedTo<double>(flow.state()), event.kind, static_cast<double>(event.duration),
                   failures))
      return;
    failures.SeeEnergy(std::fabs(SignedEnergyError(flow.state())));
    if (event.kind != EventKind::kBallPiston) continue;
    --collisions;
    flow.ExchangeComponents();
    watch.SeeExchanged(RoundedTo<double>(flow.state()), failures);
  }
}

template <typename Flow>
Failures RunByEvents(const PairGeometry& geometry, std::span<const PairState> starts,
                     uint64_t collisions) {
  Failures failures;
  for (const PairState& start : starts) RunWatched<Flow>(geometry, start, collisions, failures);
  return failures;
}

}  // namespace

const std::vector<PairMethod>& PairMethods() {
  constexpr double kAny = 0, kOfSingle = 1e-3;
  static const auto* const methods = new std::vector<PairMethod>{
      {"lanes", 1, kAny, true, RunByEngine<Engine::kLanes, double>},
      {"lanes, single", 0.1, kOfSingle, false, RunByEngine<Engine::kLanesSingle, float>},
      {"reference", 1, kAny, true, RunByEvents<ReferenceFlow>},
      {"reference, single", 0.02, kOfSingle, false, RunByEvents<EventFlow<float>>},
      {"reference, 64 bits", 0.02, kAny, true, RunByEvents<EventFlow<long double>>},
      {"reference, 113 bits", 1e-3, kAny, true, RunByEvents<EventFlow<Quadruple>>},
      {"nearest root", 0.02, kOfSingle, false,
       RunByEvents<TextbookFlow<TextbookRule::kPositiveRoot>>},
      {"nearest root, no threshold", 0.02, kOfSingle, false,
       RunByEvents<TextbookFlow<TextbookRule::kAnyRoot>>},
      {"approaching disc", 0.02, kOfSingle, false,
       RunByEvents<TextbookFlow<TextbookRule::kApproaching>>},
      {"fixed steps of 1e-3", 2e-4, kOfSingle, false, RunByEvents<FixedStepEvents>},
  };
  return *methods;
}

}  // namespace ballpiston::stability
