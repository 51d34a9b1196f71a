// Computes several blocks of orbits at once in one engine. When an orbit ends, its lane takes an
// orbit of the next block, so lanes stay full even if a block has few orbits.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "core/billiard/orbits.h"
#include "core/ensemble/open_blocks.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

// Orbits may take any time; an engine gives up an orbit that cannot end (billiard/longest_wait.h).
inline constexpr double kNoTimeLimit = std::numeric_limits<double>::infinity();

// The orbits of one block. `Orbits` has these functions:
//   uint64_t count() const;                                     at least 1
//   PairState Start(uint64_t orbit);                            called once for each orbit
//   AfterCollision Collide(uint64_t orbit, const Collision& collision);  not called for an escape
//   void AddTo(BlockResult& result) const;    in their order; called after all orbits have ended
// An experiment with tangent vectors has one function more, which follows the events of the
// reference or the waits of the lanes (OrbitSource::FollowsTangents):
//   void Follow(uint64_t orbit, const Event& event, const PairState& after);
//   void Follow(uint64_t orbit, const BallMap& flights);
template <typename Orbits, typename... Followed>
concept Follows = requires(Orbits orbits, uint64_t orbit, const Followed&... followed) {
  orbits.Follow(orbit, followed...);
};

// The orbits with their health, which counts escapes and measures the energy at collisions.
template <typename Orbits>
struct WatchedOrbits {
  Orbits orbits;
  const BlockResult& empty;
  Health health = {};

  uint64_t count() const { return orbits.count(); }

  AfterCollision Collide(uint64_t orbit, const Collision& collision) {
    if (collision.escaped) {
      ++health.escapes;
      return AfterCollision::kEnd;
    }
    const AfterCollision after = orbits.Collide(orbit, collision);
    if (collision.expired) return AfterCollision::kEnd;
    health.max_energy_error = std::max(health.max_energy_error, EnergyError(collision.state));
    return after;
  }

  BlockResult Result() const {
    BlockResult result = empty;
    orbits.AddTo(result);
    result.health = health;
    return result;
  }
};

template <typename Orbits>
class BlockOrbits : public EngineRun, private OrbitSource {
 public:
  template <typename Make>
  BlockOrbits(Engine engine, const PairGeometry& geometry, double time_limit,
              const BlockResult& empty, Make make, BlockQueue& queue)
      : time_limit_(time_limit),
        queue_(queue),
        observer_(queue.observer()),
        blocks_(queue,
                [make, &empty](const Block& block) {
                  return WatchedOrbits<Orbits>{make(block), empty};
                }),
        run_(StartOrbits(engine, geometry, *this)) {}

  bool Advance() override { return run_->Advance(); }

 private:
  size_t Start(std::span<OrbitStart> starts) override {
    for (size_t n = 0; n < starts.size(); ++n) {
      const std::optional<uint64_t> orbit = blocks_.Next();
      if (!orbit) return n;
      starts[n] = {*orbit, blocks_.WorkOf(*orbit).orbits.Start(blocks_.IndexOf(*orbit))};
    }
    return starts.size();
  }

  void Collide(std::span<OrbitCollision> collisions) override {
    for (auto& [orbit, collision, after] : collisions) {
      if (observer_ != nullptr) {
        observer_->Observe(blocks_.BlockOf(orbit), blocks_.IndexOf(orbit), collision);
      }
      after = blocks_.WorkOf(orbit).Collide(blocks_.IndexOf(orbit), collision);
      if (after == AfterCollision::kEnd) blocks_.End(orbit);
    }
  }

  static constexpr bool kFollowsEvents = Follows<Orbits, Event, PairState>;
  static constexpr bool kFollowsWaits = Follows<Orbits, BallMap>;
  bool FollowsTangents() const override { return kFollowsEvents || kFollowsWaits; }
  void FollowEvent(uint64_t orbit, const Event& event, const PairState& after) override {
    if constexpr (kFollowsEvents) FollowWith(orbit, event, after);
  }
  void FollowWait(uint64_t orbit, const BallMap& flights) override {
    if constexpr (kFollowsWaits) FollowWith(orbit, flights);
  }
  template <typename... Followed>
  void FollowWith(uint64_t orbit, const Followed&... followed) {
    blocks_.WorkOf(orbit).orbits.Follow(blocks_.IndexOf(orbit), followed...);
  }

  double TimeLimit() const override { return time_limit_; }
  OrbitDevice* Device() const override { return queue_.device(); }
  bool Pause() override { return queue_.Pause(); }

  double time_limit_;
  BlockQueue& queue_;
  CollisionObserver* const observer_;
  OpenBlocks<WatchedOrbits<Orbits>> blocks_;
  std::unique_ptr<EngineRun> run_;
};

}  // namespace ballpiston
