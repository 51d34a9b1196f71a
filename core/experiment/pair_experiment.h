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
#include "core/closed_form/mean_free_time.h"
#include "core/ensemble/block_orbits.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/geometry/pair_geometry.h"
#include "core/markov/jump_process.h"
#include "core/sampling/invariant_measure.h"

namespace ballpiston {

// The relative error of the closed mean free times.
constexpr double ErrorOfClosedForms(const PointParameters& /*point*/) {
  return kMeanFreeTimeRelativeError + kConditionalRateRelativeError;
}

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

// Finds rho, delta and epsilon outside of the billiard's domain, in the spec's precision, if the
// spec names a billiard or single precision. Where AUTO chooses, AnswerViolations
// (model_choice/ladder.h) finds them. For pairs and for gases.
void CheckBilliardDomain(const EnsembleSpec& spec, std::vector<FieldViolation>& found);

// CheckDeltas with the bound of a pair, and CheckBilliardDomain.
void CheckPairGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found);

// An engine and its blocks. Measured: up to 8.4 MB, by return experiments with blocks of 65,536.
inline constexpr double kMemoryOfPairs = 12e6;

// The work of a sample that is one collision of an orbit in equilibrium.
SampleWork WorkOfACollision(const PairGeometry& geometry);

// An orbit that the jump process can compute too. It has these functions more:
//   double StartOfWalk(const Context&, const OrbitSamples&);   returns u = sqrt(2 ep); called once
//   AfterCollision Jump(const Context&, double waiting_time, double u);  u is that after the jump
// The waiting time is in |G|/|dG_bp|. kWalkedTogether samples run until the slowest has ended;
// a stop is noticed only between such groups.
//
// This walks all orbits of a group. The first one is sample `first` of the experiment's random
// numbers.
template <typename Orbit, typename Experiment>
void Walk(const Experiment& experiment, uint64_t first, BlockOrbits<Orbit, Experiment>& orbits) {
  std::vector<double> starts(orbits.count());
  for (size_t i = 0; i < starts.size(); ++i) {
    starts[i] = orbits[i].StartOfWalk(experiment, orbits.SamplesOf(i));
  }
  const RandomStream& random = experiment.random();
  JumpWalkers walkers(random.seed, random.stream, first, std::move(starts));
  const std::span<const double> u = walkers.u(), waiting_times = walkers.waiting_times();
  std::vector<uint64_t> running(orbits.count());
  std::iota(running.begin(), running.end(), 0);
  while (!running.empty()) {
    walkers.Jump();
    std::erase_if(running, [&](uint64_t i) {
      return orbits[i].Jump(experiment, waiting_times[i], u[i]) == AfterCollision::kEnd;
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

  // The orbits of the billiard (ensemble/block_orbits.h), or those of the jump process (Walked) if
  // it answers. The context must live as long as the experiment.
  template <typename Orbit, typename Context>
  std::unique_ptr<EngineRun> RunOrbits(BlockQueue& queue, const Context& context,
                                       double time_limit = kNoTimeLimit) const {
    if constexpr (requires { Orbit::kWalkedTogether; }) {
      if (IsLimit()) {
        return RunOneByOne(queue, [&context](const Block& block, const std::stop_token& stop) {
          return Walked<Orbit>(context, block, stop);
        });
      }
    }
    return std::make_unique<OrbitRun<Orbit, Context>>(engine(), geometry_, time_limit, context,
                                                      EmptyResult(), queue);
  }

 private:
  // A block of the jump process. Empty only if `stop` was requested.
  template <typename Orbit, typename Experiment>
  static std::optional<BlockResult> Walked(const Experiment& experiment, const Block& block,
                                           const std::stop_token& stop) {
    BlockResult result = experiment.EmptyResult();
    uint64_t walkers = 0;
    for (uint64_t done = 0; done < block.samples; done += Orbit::kWalkedTogether) {
      if (stop.stop_requested()) return std::nullopt;
      const Block together = {.first = block.first + done,
                              .samples = std::min(Orbit::kWalkedTogether, block.samples - done)};
      BlockOrbits<Orbit, Experiment> orbits(experiment, together, experiment.EmptyResult());
      Walk(experiment, block.first + walkers, orbits);
      walkers += orbits.count();
      orbits.AddTo(result);
    }
    return result;
  }

  PairGeometry geometry_;
};

// An orbit in equilibrium, of as many collisions as it has samples. It starts from the return map's
// invariant measure, with the random numbers of its first sample.
struct OrbitInEquilibrium {
  OrbitSamples samples = {};
  uint64_t collisions = 0;  // that were counted

  PairState Start(const PairExperiment& experiment, const OrbitSamples& own) {
    return Draw(experiment, own, experiment.random());
  }
  PairState Draw(const PairExperiment& experiment, const OrbitSamples& own,
                 const RandomStream& stream) {
    samples = own;
    CounterRandom random = stream.Sample(own.first);
    return DrawFromCollisionMeasure(experiment.geometry(), random);
  }
  AfterCollision Count() {
    return ++collisions < samples.count ? AfterCollision::kGoOn : AfterCollision::kEnd;
  }
};

}  // namespace ballpiston
