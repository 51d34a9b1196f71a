#include "core/experiment/markov_property.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/billiard/orbits.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/markov_property_statistics.h"
#include "core/experiment/predicted_hits.h"
#include "core/experiment/without_last_bits.h"
#include "core/markov/jump_process.h"
#include "core/sampling/invariant_measure.h"

namespace ballpiston {
namespace {

// |dG_bp|/|G|.
double RateUnit(const PairGeometry& geometry) {
  return WithoutLastBits(4 / MeanFreeTimesOf(geometry).ball_piston);
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

// Energies just after a collision, of orbits first, first + length, ...; from a stream of their
// own, as the walkers use that of the samples.
std::vector<double> StartsOfWalkers(const PairGeometry& geometry, const RandomStream& random,
                                    uint64_t first, uint64_t orbits) {
  constexpr uint64_t kStartsStream = 0x9e3779b97f4a7c15;
  const RandomStream starts = {random.seed, random.stream ^ kStartsStream};
  std::vector<double> u(orbits);
  for (uint64_t i = 0; i < orbits; ++i) {
    CounterRandom draws = starts.Sample(first + i * kExchangesPerOrbit);
    u[i] = std::min(std::fabs(DrawFromCollisionMeasure(geometry, draws).piston_velocity), 1.0);
  }
  return u;
}

// By orbit, the walkers' exchanges; the last orbit may have fewer.
std::vector<Exchange> Walk(JumpWalkers& walkers, uint64_t exchanges) {
  std::vector<Exchange> all(walkers.u().size() * kExchangesPerOrbit);
  for (uint64_t n = 0; n < std::min(exchanges, kExchangesPerOrbit); ++n) {
    walkers.Jump();
    for (size_t i = 0; i < walkers.u().size(); ++i) {
      all[i * kExchangesPerOrbit + n] = {walkers.waiting_times()[i], PistonEnergy(walkers.u()[i])};
    }
  }
  all.resize(exchanges);
  return all;
}

}  // namespace

MarkovPropertyExperiment::MarkovPropertyExperiment(const EnsembleSpec& spec,
                                                   const PointParameters& point,
                                                   const PairGeometry& geometry)
    : PointExperiment(spec, point, PlanBlocks(spec, EventsPerCollision(spec.model, geometry))),
      geometry_(geometry) {}

std::optional<BlockResult> MarkovPropertyExperiment::RunBlock(uint64_t block,
                                                              std::stop_token stop) const {
  if (answer().model == Model::kMarkov) return RunJumpProcess(block);
  ExchangeOrbits orbits(geometry_, random(), plan().FirstSample(block), plan().SamplesIn(block));
  if (!RunOrbits(engine(), geometry_, orbits.count(), orbits, stop)) return std::nullopt;
  return orbits.Result();
}

BlockResult MarkovPropertyExperiment::RunJumpProcess(uint64_t block) const {
  const uint64_t first = plan().FirstSample(block), exchanges = plan().SamplesIn(block);
  const uint64_t orbits = (exchanges + kExchangesPerOrbit - 1) / kExchangesPerOrbit;
  const std::vector<double> starts = StartsOfWalkers(geometry_, random(), first, orbits);
  JumpWalkers walkers(random().seed, random().stream, first, starts);
  const std::vector<Exchange> all = Walk(walkers, exchanges);
  BlockResult result = EmptyMarkovPropertyCounts();
  for (uint64_t i = 0; i < orbits; ++i) {
    const uint64_t begin = i * kExchangesPerOrbit;
    const uint64_t length = std::min(kExchangesPerOrbit, exchanges - begin);
    CountOrbit(PistonEnergy(starts[i]), std::span(all).subspan(begin, length), result);
  }
  return result;
}

BlockResult MarkovPropertyExperiment::EmptyResult() const { return EmptyMarkovPropertyCounts(); }

// The jump process has no memory; the billiard's is what is measured.
std::optional<double> MarkovPropertyExperiment::ExactCorrelation() const {
  return answer().model == Model::kMarkov ? std::optional(0.0) : std::nullopt;
}

Estimate MarkovPropertyExperiment::FirstEstimate(const BlockResult& merged) const {
  return MarkovPropertyEstimates(merged, ExactCorrelation()).front();
}

PointSummary MarkovPropertyExperiment::Summarize(const BlockResult& merged) const {
  return {.samples = merged.samples,
          .estimates = MarkovPropertyEstimates(merged, ExactCorrelation()),
          .health = merged.health};
}

}  // namespace ballpiston
