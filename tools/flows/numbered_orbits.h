// Orbits of an engine that have numbers from 0, with one call for each start and for each contact.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <utility>

#include "core/billiard/orbits.h"

namespace ballpiston {

class NumberedOrbits {
 public:
  virtual ~NumberedOrbits() = default;
  virtual PairState Start(uint64_t orbit) = 0;
  virtual AfterContact Meet(uint64_t orbit, const Contact& contact) = 0;
};

template <typename Orbits>
class SourceOfNumbered : public OrbitSource {
 public:
  SourceOfNumbered(uint64_t count, Orbits& orbits, std::stop_token stop)
      : count_(count), orbits_(orbits), stop_(std::move(stop)) {}

  size_t Start(std::span<OrbitStart> starts) override {
    size_t n = 0;
    for (; n < starts.size() && next_ < count_; ++n, ++next_) {
      starts[n] = {next_, orbits_.Start(next_)};
    }
    return n;
  }
  void Meet(std::span<Meeting> meetings) override {
    for (Meeting& meeting : meetings) meeting.after = orbits_.Meet(meeting.orbit, meeting.contact);
  }
  double TimeLimit() const override {
    if constexpr (requires { orbits_.TimeLimit(); }) return orbits_.TimeLimit();
    return OrbitSource::TimeLimit();
  }
  bool Pause() override { return stop_.stop_requested(); }

 private:
  uint64_t count_;
  Orbits& orbits_;
  std::stop_token stop_;
  uint64_t next_ = 0;
};

// Runs orbits 0 ... count - 1 to their ends. Returns false if `stop` was requested before. `orbits`
// has the functions of NumberedOrbits, and may have that of OrbitSource for a time limit.
template <typename Orbits>
bool RunOrbits(Engine engine, const PairGeometry& geometry, uint64_t count, Orbits& orbits,
               const std::stop_token& stop = {}) {
  SourceOfNumbered source(count, orbits, stop);
  return StartOrbits(engine, geometry, source)->Advance();
}

}  // namespace ballpiston
