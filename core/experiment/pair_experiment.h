// The base of all experiments with a ball-piston pair, and functions that their rows share.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "core/ensemble/block_orbits.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/geometry/pair_geometry.h"
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

class PairExperiment : public PointExperiment {
 public:
  const PairGeometry& geometry() const { return geometry_; }

 protected:
  PairExperiment(const EnsembleSpec& spec, const PointParameters& point)
      : PointExperiment(spec, point), geometry_(GeometryOf(point)) {}

  // Whether the jump process answers, and not the billiard.
  bool IsLimit() const { return answer().model == Model::kMarkov; }

  // `make` makes the orbits of a block (ensemble/block_orbits.h): Orbits make(const Block&).
  template <typename Make>
  std::unique_ptr<EngineRun> RunOrbits(BlockQueue& queue, Make make,
                                       double time_limit = kNoTimeLimit) const {
    using Orbits = decltype(make(Block()));
    return std::make_unique<BlockOrbits<Orbits>>(engine(), geometry_, time_limit, std::move(make),
                                                 queue);
  }

 private:
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
  PairState Draw(uint64_t orbit) const {
    CounterRandom random = experiment_.random().Sample(block_.first + orbit * length_);
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
