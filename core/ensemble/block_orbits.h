// Computes several blocks of orbits at once in one engine. When an orbit ends, its lane takes an
// orbit of the next block, so lanes stay full even if a block has few orbits.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/ensemble/open_blocks.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

// Orbits may take any time; an engine gives up an orbit that cannot end (billiard/longest_wait.h).
inline constexpr double kNoTimeLimit = std::numeric_limits<double>::infinity();

// The samples of one orbit: first ... first + count - 1 of the point.
struct OrbitSamples {
  uint64_t first;
  uint64_t count;
};

// The orbits of one block, with their health: the escapes, and the energy at collisions.
//
// `Orbit` is one of them, and adds its measurements to the block's result. `Context` is what all
// orbits share, such as the experiment. An orbit has these functions:
//   static uint64_t LengthIn(const Block& block);    samples of an orbit; the last may have fewer
//   PairState Start(const Context&, const OrbitSamples&);                     called once
//   AfterCollision Collide(const Context&, const Collision&);                 not for an escape
//   void AddTo(const Context&, BlockResult&) const;    in their order, after all orbits have ended
// An orbit with tangent vectors has them in a std::optional `tangents`. If the reference computes
// the orbits, the tangents have this function, which FollowEvent calls:
//   void Follow(const Event& event, const PairState& after);
template <typename Orbit, typename Context>
class BlockOrbits {
 public:
  // The context and the empty result must outlive the orbits.
  BlockOrbits(const Context& context, const Block& block, const BlockResult& empty)
      : context_(context),
        empty_(empty),
        block_(block),
        length_(Orbit::LengthIn(block)),
        orbits_((block.samples + length_ - 1) / length_) {}

  uint64_t count() const { return orbits_.size(); }
  Orbit& operator[](uint64_t i) { return orbits_[i]; }
  OrbitSamples SamplesOf(uint64_t i) const {
    return {block_.first + i * length_, std::min(length_, block_.samples - i * length_)};
  }

  PairState Start(uint64_t i) { return orbits_[i].Start(context_, SamplesOf(i)); }

  AfterCollision Collide(uint64_t i, const Collision& collision) {
    if (collision.escaped) {
      ++health_.escapes;
      return AfterCollision::kEnd;
    }
    const AfterCollision after = orbits_[i].Collide(context_, collision);
    if (collision.expired) return AfterCollision::kEnd;
    health_.max_energy_error = std::max(health_.max_energy_error, EnergyError(collision.state));
    return after;
  }

  void AddTo(BlockResult& result) const {
    for (const Orbit& orbit : orbits_) orbit.AddTo(context_, result);
    result.health.Merge(health_);
  }

  BlockResult Result() const {
    BlockResult result = empty_;
    AddTo(result);
    return result;
  }

 private:
  const Context& context_;
  const BlockResult& empty_;
  Block block_;
  uint64_t length_;
  std::vector<Orbit> orbits_;
  Health health_;
};

// The orbits of several blocks in one engine. The context and the empty result must outlive it.
template <typename Orbit, typename Context>
class OrbitRun : public EngineRun, private OrbitSource {
 public:
  OrbitRun(Engine engine, const PairGeometry& geometry, double time_limit, const Context& context,
           const BlockResult& empty, BlockQueue& queue)
      : time_limit_(time_limit),
        queue_(queue),
        observer_(queue.observer()),
        blocks_(queue,
                [&context, &empty](const Block& block) {
                  return BlockOrbits<Orbit, Context>(context, block, empty);
                }),
        run_(StartOrbits(engine, geometry, *this)) {}

  bool Advance() override { return run_->Advance(); }

 private:
  std::optional<OrbitStart> Next() override {
    const std::optional<uint64_t> orbit = blocks_.Next();
    if (!orbit) return std::nullopt;
    return OrbitStart{*orbit, blocks_.WorkOf(*orbit).Start(blocks_.IndexOf(*orbit))};
  }

  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    const uint64_t index = blocks_.IndexOf(orbit);
    if (observer_ != nullptr) observer_->Observe(blocks_.BlockOf(orbit), index, collision);
    const AfterCollision after = blocks_.WorkOf(orbit).Collide(index, collision);
    if (after == AfterCollision::kEnd) blocks_.End(orbit);
    return after;
  }

  bool FollowsTangents() const override {
    return requires(Orbit orbit) { orbit.tangents; };
  }
  void FollowEvent(uint64_t number, const Event& event, const PairState& after) override {
    Orbit& orbit = blocks_.WorkOf(number)[blocks_.IndexOf(number)];
    if constexpr (requires { orbit.tangents->Follow(event, after); }) {
      orbit.tangents->Follow(event, after);
    }
  }

  double TimeLimit() const override { return time_limit_; }
  OrbitDevice* Device() const override { return queue_.device(); }
  bool Pause() override { return queue_.Pause(); }

  double time_limit_;
  BlockQueue& queue_;
  CollisionObserver* const observer_;
  OpenBlocks<BlockOrbits<Orbit, Context>> blocks_;
  std::unique_ptr<EngineRun> run_;
};

}  // namespace ballpiston
