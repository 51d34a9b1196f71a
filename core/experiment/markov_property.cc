// Tests whether the billiard's energy exchanges are a Markov jump process, beyond the first hit. It
// measures the laws of the waiting time and of the energy after it, given the energy before, and
// their memory of the previous exchange (markov_property_statistics.h).
//
// A block is many orbits of kExchangesPerOrbit collisions. Each orbit starts from the return map's
// invariant measure, so all exchanges are in equilibrium.
//
// At a given delta the billiard differs from the limit for two reasons. Ball and piston cannot meet
// again at once, and a piston at speed u passes the collision surface periodically, with period
// 2 (lambda + 2 delta)/u. This affects a fraction of order delta^2/u of its hits. Every octave of u
// adds the same amount to the Kolmogorov-Smirnov distance, down to u of order delta^2, where the
// return law is not exponential at all. In measurements the distance falls as delta^2 log(1/delta).
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/arithmetic/elementary_functions.h"
#include "core/billiard/orbits.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/markov_property_statistics.h"
#include "core/experiment/pair_experiment.h"
#include "core/markov/jump_process.h"
#include "core/sampling/invariant_measure.h"

namespace ballpiston {
namespace {

// |dG_bp|/|G|.
double RateUnit(const PairGeometry& geometry) {
  return WithoutLastBits(4 / MeanFreeTimesOf(geometry).ball_piston);
}

// Rounding may give more than the pair's energy of 1/2.
double PistonEnergy(double velocity) { return std::min(velocity * velocity / 2, 0.5); }

class ExchangeOrbits : public OrbitsInEquilibrium {
 public:
  ExchangeOrbits(const PairExperiment& experiment, const Block& block)
      : OrbitsInEquilibrium(experiment, block, kExchangesPerOrbit),
        rate_unit_(RateUnit(experiment.geometry())),
        exchanges_(block.samples),
        orbits_(count()) {}

  PairState Start(uint64_t orbit) {
    const PairState state = Draw(orbit);
    orbits_[orbit].first_energy = PistonEnergy(state.piston_velocity);
    return state;
  }

  AfterCollision Collide(uint64_t index, const Collision& collision) {
    Orbit& orbit = orbits_[index];
    const PairState& state = collision.state;
    // After the collision the piston has the ball's normal velocity component.
    exchanges_[index * kExchangesPerOrbit + orbit.exchanges++] = {
        .waiting_time = collision.time * rate_unit_,
        .energy = PistonEnergy(state.ball_speed * state.direction.x())};
    return After(index, orbit.exchanges);
  }

  BlockResult Result() const {
    BlockResult result = experiment_.EmptyResult();
    for (size_t i = 0; i < orbits_.size(); ++i) {
      const std::span all(exchanges_);
      CountOrbit(block_.first / kExchangesPerOrbit + i, orbits_[i].first_energy,
                 all.subspan(i * kExchangesPerOrbit, orbits_[i].exchanges), result);
    }
    return result;
  }

 private:
  struct Orbit {
    double first_energy = 0;
    uint64_t exchanges = 0;
  };

  double rate_unit_;
  std::vector<Exchange> exchanges_;  // of all orbits, one orbit after the other
  std::vector<Orbit> orbits_;
};

// Energies just after a collision, of orbits first, first + length, ... They have their own stream,
// because the walkers use the stream of the samples.
std::vector<double> StartsAfterCollisions(const PairGeometry& geometry, const RandomStream& random,
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

// The walkers' exchanges, by orbit. The last orbit may have fewer exchanges.
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

// Some orbits of a block whose first sample is block_first: orbits from number `first_orbit` on,
// which have `exchanges` exchanges together.
void WalkOrbits(const PairGeometry& geometry, const RandomStream& random, uint64_t block_first,
                uint64_t first_orbit, uint64_t exchanges, BlockResult& result) {
  const uint64_t orbits = (exchanges + kExchangesPerOrbit - 1) / kExchangesPerOrbit;
  const std::vector<double> starts = StartsAfterCollisions(
      geometry, random, block_first + first_orbit * kExchangesPerOrbit, orbits);
  JumpWalkers walkers(random.seed, random.stream, block_first + first_orbit, starts);
  const std::vector<Exchange> all = Walk(walkers, exchanges);
  for (uint64_t i = 0; i < orbits; ++i) {
    const uint64_t begin = i * kExchangesPerOrbit;
    const uint64_t length = std::min(kExchangesPerOrbit, exchanges - begin);
    CountOrbit(block_first / kExchangesPerOrbit + first_orbit + i, PistonEnergy(starts[i]),
               std::span(all).subspan(begin, length), result);
  }
}

// A block of the jump process itself. Empty only if `stop` was requested.
std::optional<BlockResult> WalkExchanges(const PairGeometry& geometry, const RandomStream& random,
                                         const Block& block, const std::stop_token& stop) {
  constexpr uint64_t kOrbitsTogether = 64;  // about 1 ms
  constexpr uint64_t kTogether = kOrbitsTogether * kExchangesPerOrbit;
  BlockResult result = EmptyMarkovPropertyCounts();
  for (uint64_t done = 0; done < block.samples; done += kTogether) {
    if (stop.stop_requested()) return std::nullopt;
    WalkOrbits(geometry, random, block.first, done / kExchangesPerOrbit,
               std::min(kTogether, block.samples - done), result);
  }
  return result;
}

// By billiard, billiard_reference, or markov, which is a control: the jump process has no memory;
// for the billiard the memory is unknown.
class MarkovPropertyExperiment : public PairExperiment {
 public:
  MarkovPropertyExperiment(const EnsembleSpec& spec, const PointParameters& point)
      : PairExperiment(spec, point) {
    SetMeasurements(EmptyMarkovPropertyCounts(), MarkovPropertyTable(IsLimit()));
  }

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override {
    if (IsLimit()) {
      return RunOneByOne(queue, [this](const Block& block, const std::stop_token& stop) {
        return WalkExchanges(geometry(), random(), block, stop);
      });
    }
    return RunOrbits(queue, [this](const Block& block) { return ExchangeOrbits(*this, block); });
  }
};

SampleWork WorkOfAnExchange(Model model, const PointParameters& point) {
  return model == Model::kMarkov ? SampleWork{.jumps = 1} : WorkOfACollision(GeometryOf(point));
}

double ErrorOfWhatTendsToZero(Model, const PointParameters&) {
  return std::numeric_limits<double>::infinity();
}

double OrbitsOfAnExchange(Model, const PointParameters&) { return 1.0 / kExchangesPerOrbit; }

constexpr Model kModelsOfMarkovProperty[] = {Model::kMarkov, Model::kBilliard,
                                             Model::kBilliardReference};

constexpr absl::string_view kTendsToZero =
    "it tends to 0; permitted: samples, collisions or a budget";

constexpr AimedEstimate kAimsOfMarkovProperty[] = {{.name = "memory_correlation",
                                                    .models = kModelsOfMarkovProperty,
                                                    .error = ErrorOfWhatTendsToZero,
                                                    .events = OrbitsOfAnExchange,
                                                    .no_error = kTendsToZero}};

}  // namespace

constinit const ExperimentKind kMarkovProperty = {.name = "markov-property",
                                                  .number = 5,
                                                  .parameters = kPairAlone,
                                                  .models = kModelsOfMarkovProperty,
                                                  .aims = kAimsOfMarkovProperty,
                                                  .create = CreateAs<MarkovPropertyExperiment>,
                                                  .check_grid = CheckPairGrid,
                                                  .work = WorkOfAnExchange,
                                                  .collisions = OneCollision,
                                                  .memory = MemoryOfPairs,
                                                  .memory_of_a_result = 120e3,
                                                  .samples_together = kExchangesPerOrbit};

}  // namespace ballpiston
