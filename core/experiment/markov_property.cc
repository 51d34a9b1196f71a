#include "core/experiment/markov_property.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/markov_property_statistics.h"
#include "core/sampling/invariant_measure.h"

namespace ballpiston {
namespace {

double EventsPerCollision(const PairGeometry& geometry) {
  const MeanFreeTimes tau = MeanFreeTimesOf(geometry);
  return 1 + tau.ball_piston / tau.ball_wall + tau.ball_piston / tau.piston_wall;
}

// |dG_bp|/|G|. Its last bits depend on the processor's sines, and would show in every sum over
// waiting times. Rounded to 2^-30 they do not, unless one geometry in a million hits the edge; the
// largest count that could tell is 1e18 samples.
double RateUnit(const PairGeometry& geometry) {
  int exponent;
  const double mantissa = std::frexp(4 / MeanFreeTimesOf(geometry).ball_piston, &exponent);
  return std::ldexp(std::round(mantissa * 0x1p30), exponent - 30);
}

// Rounding may leave more than the pair has.
double PistonEnergy(double velocity) { return std::min(velocity * velocity / 2, 0.5); }

// `collisions` of them over orbits that start at numbers first, first + length, ...
class ExchangeOrbits : public OrbitSource {
 public:
  ExchangeOrbits(const PairGeometry& geometry, const RandomStream& random, uint64_t first,
                 uint64_t collisions)
      : geometry_(geometry),
        random_(random),
        first_(first),
        rate_unit_(RateUnit(geometry)),
        exchanges_(collisions),
        orbits_((collisions + kExchangesPerOrbit - 1) / kExchangesPerOrbit) {}

  uint64_t count() const { return orbits_.size(); }

  PairState Start(uint64_t orbit) override {
    CounterRandom random = random_.Sample(first_ + orbit * kExchangesPerOrbit);
    const PairState state = DrawFromCollisionMeasure(geometry_, random);
    orbits_[orbit].first_energy = PistonEnergy(state.piston_velocity);
    return state;
  }

  AfterContact Meet(uint64_t index, const Contact& contact) override {
    Orbit& orbit = orbits_[index];
    if (contact.escaped) {
      ++orbit.health.escapes;
      return AfterContact::kEnd;
    }
    const PairState& state = contact.state;
    orbit.health.max_energy_error = std::max(orbit.health.max_energy_error, EnergyError(state));
    // The piston leaves with the ball's component.
    exchanges_[index * kExchangesPerOrbit + orbit.exchanges++] = {
        .waiting_time = contact.time * rate_unit_,
        .energy = PistonEnergy(state.ball_speed * state.direction.x())};
    return orbit.exchanges < Length(index) ? AfterContact::kGoOn : AfterContact::kEnd;
  }

  BlockResult Result() const {
    BlockResult result = EmptyMarkovPropertyCounts();
    for (size_t i = 0; i < orbits_.size(); ++i) {
      const std::span all(exchanges_);
      CountOrbit(orbits_[i].first_energy, all.subspan(i * kExchangesPerOrbit, orbits_[i].exchanges),
                 result);
      result.health.Merge(orbits_[i].health);
    }
    return result;
  }

 private:
  struct Orbit {
    double first_energy = 0;
    uint64_t exchanges = 0;
    Health health;
  };

  uint64_t Length(uint64_t orbit) const {
    return std::min<uint64_t>(kExchangesPerOrbit, exchanges_.size() - orbit * kExchangesPerOrbit);
  }

  PairGeometry geometry_;
  RandomStream random_;
  uint64_t first_;
  double rate_unit_;
  std::vector<Exchange> exchanges_;  // each orbit's after those of the orbit before
  std::vector<Orbit> orbits_;
};

}  // namespace

MarkovPropertyExperiment::MarkovPropertyExperiment(const EnsembleSpec& spec,
                                                   const PointParameters& point,
                                                   const PairGeometry& geometry)
    : PointExperiment(spec, point, PlanBlocks(spec, EventsPerCollision(geometry))),
      geometry_(geometry) {}

std::optional<BlockResult> MarkovPropertyExperiment::RunBlock(uint64_t block,
                                                              std::stop_token stop) const {
  ExchangeOrbits orbits(geometry_, random(), plan().FirstSample(block), plan().SamplesIn(block));
  if (!RunOrbits(engine(), geometry_, orbits.count(), orbits, stop)) return std::nullopt;
  return orbits.Result();
}

Estimate MarkovPropertyExperiment::FirstEstimate(const BlockResult& merged) const {
  return MarkovPropertyEstimates(merged, std::nullopt).front();
}

PointSummary MarkovPropertyExperiment::Summarize(const BlockResult& merged) const {
  return {.samples = merged.samples,
          .estimates = MarkovPropertyEstimates(merged, std::nullopt),
          .health = merged.health};
}

}  // namespace ballpiston
