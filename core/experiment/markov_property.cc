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
#include <span>
#include <vector>

#include "core/arithmetic/elementary_functions.h"
#include "core/billiard/orbits.h"
#include "core/closed_form/mean_free_time.h"
#include "core/experiment/all_experiments.h"
#include "core/experiment/markov_property_statistics.h"
#include "core/experiment/pair_experiment.h"

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
  static constexpr uint64_t kWalkedTogether = 64 * kExchangesPerOrbit;  // about 1 ms

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

  AfterCollision Collide(uint64_t orbit, const Collision& collision) {
    // After the collision the piston has the ball's normal velocity component.
    const PairState& state = collision.state;
    return Jump(orbit, collision.time * rate_unit_, state.ball_speed * state.direction.x());
  }

  // Starts have their own stream, because the walkers use the stream of the samples.
  double StartOfWalk(uint64_t orbit) {
    constexpr uint64_t kStartsStream = 0x9e3779b97f4a7c15;
    RandomStream starts = experiment_.random();
    starts.stream ^= kStartsStream;
    const double u = std::min(std::fabs(Draw(orbit, starts).piston_velocity), 1.0);
    orbits_[orbit].first_energy = PistonEnergy(u);
    return u;
  }

  AfterCollision Jump(uint64_t index, double waiting_time, double piston_velocity) {
    Orbit& orbit = orbits_[index];
    exchanges_[index * kExchangesPerOrbit + orbit.exchanges++] = {waiting_time,
                                                                  PistonEnergy(piston_velocity)};
    return After(index, orbit.exchanges);
  }

  void AddTo(BlockResult& result) const {
    for (size_t i = 0; i < orbits_.size(); ++i) {
      const std::span all(exchanges_);
      CountOrbit(block_.first / kExchangesPerOrbit + i, orbits_[i].first_energy,
                 all.subspan(i * kExchangesPerOrbit, orbits_[i].exchanges), result);
    }
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

// By billiard, billiard_reference, or markov, which is a control: the jump process has no memory;
// for the billiard the memory is unknown.
class MarkovPropertyExperiment : public PairExperiment {
 public:
  MarkovPropertyExperiment(const EnsembleSpec& spec, const PointParameters& point)
      : PairExperiment(spec, point) {
    SetMeasurements(EmptyMarkovPropertyCounts(), MarkovPropertyTable(IsLimit()));
  }

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override {
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
