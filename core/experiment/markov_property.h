// Whether the billiard's energy exchanges are a Markov jump process, beyond the first hit: the laws
// of waiting time and of the energy after it, given the energy before, and what they remember of
// the exchange before last (markov_property_statistics.h).
//
// A block is many orbits of kExchangesPerOrbit collisions, each started from the return map's
// invariant measure, so that every exchange is one of equilibrium.
//
// What keeps the billiard from the limit at a given delta: ball and piston cannot meet again at
// once, and a piston at speed u passes the collision surface by a clock of period
// 2 (lambda + 2 delta)/u. A fraction of order delta^2/u of its hits is off by that, and every
// octave of u down to order delta^2, where the return law is not exponential at all, adds as much
// to the Kolmogorov-Smirnov distance: measured, the distance falls as delta^2 log(1/delta).
#ifndef BALLPISTON_CORE_EXPERIMENT_MARKOV_PROPERTY_H_
#define BALLPISTON_CORE_EXPERIMENT_MARKOV_PROPERTY_H_

#include <cstdint>
#include <optional>
#include <stop_token>

#include "core/experiment/point_experiment.h"
#include "core/geometry/pair_geometry.h"

namespace ballpiston {

// Enough that the one exchange of an orbit that has no other before it costs little, and few enough
// that orbits fill the lanes.
inline constexpr uint64_t kExchangesPerOrbit = 32;

// By billiard, billiard_reference, or, as its own control, markov.
class MarkovPropertyExperiment : public PointExperiment {
 public:
  MarkovPropertyExperiment(const EnsembleSpec& spec, const PointParameters& point,
                           const PairGeometry& geometry);

  std::optional<BlockResult> RunBlock(uint64_t block, std::stop_token stop) const override;
  BlockResult EmptyResult() const override;
  Estimate FirstEstimate(const BlockResult& merged) const override;
  PointSummary Summarize(const BlockResult& merged) const override;

 private:
  BlockResult RunJumpProcess(uint64_t block) const;
  std::optional<double> ExactCorrelation() const;

  PairGeometry geometry_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_MARKOV_PROPERTY_H_
