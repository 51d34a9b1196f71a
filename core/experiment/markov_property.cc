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
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

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

// By billiard, billiard_reference, or markov, which is a control: the jump process has no memory;
// for the billiard the memory is unknown.
class MarkovPropertyExperiment : public PairExperiment {
 public:
  MarkovPropertyExperiment(const EnsembleSpec& spec, const PointParameters& point)
      : PairExperiment(spec, point), rate_unit_(RateUnit(geometry())) {
    SetMeasurements(EmptyMarkovPropertyCounts(), MarkovPropertyTable(IsLimit()));
  }

  double rate_unit() const { return rate_unit_; }

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override;

 private:
  double rate_unit_;
};

struct ExchangeOrbit : OrbitInEquilibrium {
  double first_energy = 0;
  std::array<Exchange, kExchangesPerOrbit> exchanges;

  static constexpr uint64_t kWalkedTogether = 64 * kExchangesPerOrbit;  // about 1 ms
  static uint64_t LengthIn(const Block&) { return kExchangesPerOrbit; }

  PairState Start(const MarkovPropertyExperiment& experiment, const OrbitSamples& own) {
    const PairState state = OrbitInEquilibrium::Start(experiment, own);
    first_energy = PistonEnergy(state.piston_velocity);
    return state;
  }

  AfterCollision Collide(const MarkovPropertyExperiment& experiment, const Collision& collision) {
    // After the collision the piston has the ball's normal velocity component.
    const PairState& state = collision.state;
    return Jump(experiment, collision.time * experiment.rate_unit(),
                state.ball_speed * state.direction.x());
  }

  // Starts have their own stream, because the walkers use the stream of the samples.
  double StartOfWalk(const MarkovPropertyExperiment& experiment, const OrbitSamples& own) {
    constexpr uint64_t kStartsStream = 0x9e3779b97f4a7c15;
    RandomStream starts = experiment.random();
    starts.stream ^= kStartsStream;
    const double velocity = Draw(experiment, own, starts).piston_velocity;
    const double u = std::min(std::fabs(velocity), 1.0);
    first_energy = PistonEnergy(u);
    return u;
  }

  AfterCollision Jump(const MarkovPropertyExperiment&, double waiting_time,
                      double piston_velocity) {
    exchanges[collisions] = {waiting_time, PistonEnergy(piston_velocity)};
    return Count();
  }

  void AddTo(const MarkovPropertyExperiment&, BlockResult& result) const {
    CountOrbit(samples.first / kExchangesPerOrbit, first_energy,
               std::span(exchanges).first(collisions), result);
  }
};

std::unique_ptr<EngineRun> MarkovPropertyExperiment::StartRun(BlockQueue& queue) const {
  return RunOrbits<ExchangeOrbit>(queue, *this);
}

Forecast ForecastOfAnExchange(Model model, const PointParameters& point) {
  const SampleWork jump = {.jumps = 1};
  return {.work = model == Model::kMarkov ? jump : WorkOfACollision(GeometryOf(point)),
          .memory = kMemoryOfPairs};
}

// The correlation tends to 0, so no number of samples gives a relative error.
Scatter ScatterOfMemory(Model, const PointParameters&) {
  return {std::numeric_limits<double>::infinity(), 1.0 / kExchangesPerOrbit};
}

constexpr Model kModelsOfMarkovProperty[] = {Model::kMarkov, Model::kBilliard,
                                             Model::kBilliardReference};

constexpr absl::string_view kTendsToZero =
    "it tends to 0; permitted: samples, collisions or a budget";

constexpr AimedEstimate kAimsOfMarkovProperty[] = {{.name = "memory_correlation",
                                                    .models = kModelsOfMarkovProperty,
                                                    .scatter = ScatterOfMemory,
                                                    .no_error = kTendsToZero}};

}  // namespace

constinit const ExperimentKind kMarkovProperty = {.name = "markov-property",
                                                  .number = 5,
                                                  .parameters = kPairAlone,
                                                  .aims = kAimsOfMarkovProperty,
                                                  .create = CreateAs<MarkovPropertyExperiment>,
                                                  .check_grid = CheckPairGrid,
                                                  .forecast = ForecastOfAnExchange,
                                                  .memory_of_a_result = 120e3,
                                                  .samples_together = kExchangesPerOrbit};

}  // namespace ballpiston
