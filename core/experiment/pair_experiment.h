// The base of all experiments with a ball-piston pair, and functions that their rows share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "core/ensemble/block_orbits.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/geometry/pair_geometry.h"
#include "core/markov/jump_process.h"
#include "core/sampling/invariant_measure.h"

namespace ballpiston {

inline constexpr ParameterUse kPairAlone[] = {{&kRho}, {&kDelta}};

inline constexpr Model kBilliards[] = {Model::kBilliard, Model::kBilliardReference};

// Requires a valid rho and delta.
PairGeometry GeometryOf(const PointParameters& point);

using DeltaValidation = absl::Status (*)(double rho, double delta);

// Finds deltas that are not permitted at the largest rho beside them, and deltas so small that the
// mean free time of the smallest rho is so large that its powers leave the range of double.
void CheckDeltas(const Grid& grid, DeltaValidation validate, std::vector<FieldViolation>& found);

// Whether a billiard engine of the spec's precision is sound at the point
// (billiard/billiard_domain.h).
bool IsSoundForBilliard(const EnsembleSpec& spec, const PointParameters& point);

// Finds rho and delta outside of the billiard's domain, in the spec's precision, if the spec names
// a billiard or single precision. Where AUTO chooses, DomainViolations (model_choice/ladder.h)
// finds them. For pairs and for gases.
void CheckBilliardDomain(const EnsembleSpec& spec, std::vector<FieldViolation>& found);

// CheckDeltas with the bound of a pair, and CheckBilliardDomain.
void CheckPairGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found);

inline double OneCollision(Model, const PointParameters&) { return 1; }

// An engine and its blocks. Measured: up to 8.4 MB, by return experiments with blocks of 65,536.
inline double MemoryOfPairs(Model, const PointParameters&) { return 12e6; }

// The work of a sample that is one collision of an orbit in equilibrium.
SampleWork WorkOfACollision(const PairGeometry& geometry);

// The orbits of a block that the jump process can compute too. They have these functions more:
//   double StartOfWalk(uint64_t orbit);             returns u = sqrt(2 ep), once for each orbit
//   AfterCollision Jump(uint64_t orbit, double waiting_time, double u);  u is that after the jump
// The waiting time is in |G|/|dG_bp|. kWalkedTogether samples run until the slowest has ended;
// a stop is noticed only between such groups.
template <typename Orbits>
concept CanWalk = requires {
  Orbits::kWalkedTogether;
};

// A walk of all orbits, of which the first one is sample `first` of its random numbers.
template <typename Orbits>
void Walk(const RandomStream& random, uint64_t first, Orbits& orbits) {
  std::vector<double> starts(orbits.count());
  for (size_t i = 0; i < starts.size(); ++i) starts[i] = orbits.StartOfWalk(i);
  JumpWalkers walkers(random.seed, random.stream, first, std::move(starts));
  const std::span<const double> u = walkers.u(), waiting_times = walkers.waiting_times();
  std::vector<uint64_t> running(orbits.count());
  std::iota(running.begin(), running.end(), 0);
  while (!running.empty()) {
    walkers.Jump();
    std::erase_if(running, [&](uint64_t i) {
      return orbits.Jump(i, waiting_times[i], u[i]) == AfterCollision::kEnd;
    });
  }
}

class PairExperiment : public PointExperiment {
 public:
  const PairGeometry& geometry() const { return geometry_; }

 protected:
  PairExperiment(const EnsembleSpec& spec, const PointParameters& point)
      : PointExperiment(spec, point), geometry_(GeometryOf(point)) {}

  // Whether the jump process answers, and not the billiard.
  bool IsLimit() const { return answer().model == Model::kMarkov; }

  // `make` makes the orbits of a block, Orbits make(const Block&): those of the billiard
  // (ensemble/block_orbits.h), or those of the jump process (Walked) if it answers.
  template <typename Make>
  std::unique_ptr<EngineRun> RunOrbits(BlockQueue& queue, Make make,
                                       double time_limit = kNoTimeLimit) const {
    using Orbits = decltype(make(Block()));
    if constexpr (CanWalk<Orbits>) {
      if (IsLimit()) {
        return RunOneByOne(queue, [=, this](const Block& block, const std::stop_token& stop) {
          return Walked(block, make, stop);
        });
      }
    }
    return std::make_unique<BlockOrbits<Orbits>>(engine(), geometry_, time_limit, EmptyResult(),
                                                 std::move(make), queue);
  }

 private:
  // A block of the jump process. Empty only if `stop` was requested.
  template <typename Make>
  std::optional<BlockResult> Walked(const Block& block, Make make,
                                    const std::stop_token& stop) const {
    constexpr uint64_t kTogether = decltype(make(block))::kWalkedTogether;
    BlockResult result = EmptyResult();
    uint64_t walkers = 0;
    for (uint64_t done = 0; done < block.samples; done += kTogether) {
      if (stop.stop_requested()) return std::nullopt;
      auto orbits = make(
          Block{.first = block.first + done, .samples = std::min(kTogether, block.samples - done)});
      Walk(random(), block.first + walkers, orbits);
      walkers += orbits.count();
      orbits.AddTo(result);
    }
    return result;
  }

  PairGeometry geometry_;
};

// A block's collisions in equilibrium, as orbits of at most `length` collisions each. Each orbit
// starts from the return map's invariant measure, with the random numbers of its first collision.
class OrbitsInEquilibrium {
 public:
  OrbitsInEquilibrium(const PairExperiment& experiment, const Block& block, uint64_t length)
      : experiment_(experiment), block_(block), length_(length) {}

  uint64_t count() const { return (block_.samples + length_ - 1) / length_; }

 protected:
  PairState Draw(uint64_t orbit) const { return Draw(orbit, experiment_.random()); }
  PairState Draw(uint64_t orbit, const RandomStream& stream) const {
    CounterRandom random = stream.Sample(block_.first + orbit * length_);
    return DrawFromCollisionMeasure(experiment_.geometry(), random);
  }
  // `collisions`: those of the orbit so far.
  AfterCollision After(uint64_t orbit, uint64_t collisions) const {
    const uint64_t last = std::min(length_, block_.samples - orbit * length_);
    return collisions < last ? AfterCollision::kGoOn : AfterCollision::kEnd;
  }

  const PairExperiment& experiment_;
  Block block_;
  uint64_t length_;
};

}  // namespace ballpiston
