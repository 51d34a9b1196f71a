#include "tools/stability/gas_energy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/geometry/paper.h"
#include "tools/stability/error_size.h"
#include "tools/stability/fixed_step_gas_events.h"
#include "tools/stability/gas_methods.h"
#include "tools/stability/metered_gases.h"
#include "tools/stability/textbook_gas.h"

namespace ballpiston::stability {
namespace {

constexpr uint64_t kGasEnergySeed = 25;
constexpr uint64_t kGases = 48;
constexpr double kUlp = std::numeric_limits<double>::epsilon();

GasGeometry EnergyGas() {
  return *GasGeometry::Create(kPaperRho, 0.2, *ParseGasShape("4x3"), GasEnds::kPeriodic);
}

std::vector<GasReplica> EnergyReplicas() {
  std::vector<GasReplica> replicas;
  for (uint64_t i = 0; i < kGases; ++i) {
    const GasRandom random(kGasEnergySeed, 0, i);
    CounterRandom of_start = random.OfStart();
    replicas.push_back({DrawGas(EnergyGas(), TemperatureProfile(1), of_start), {}, random});
  }
  return replicas;
}

// The time in which each gas has about this number of exchanges.
double TimeOf(double exchanges) {
  const GasGeometry gas = EnergyGas();
  return exchanges / (static_cast<double>(gas.contacts()) * GasExchangeRate(gas, 1));
}

GasEnergyRun OfEngine(const char* name, GasEngine engine, double exchanges) {
  GasEnergyRun run = {.method = name, .promised = true};
  const std::vector<GasReplica> replicas = EnergyReplicas();
  MeteredGases gases(engine, EnergyGas(), replicas);
  gases.AdvanceTo(TimeOf(exchanges));
  for (size_t i = 0; i < gases.size(); ++i) {
    run.exchanges += gases.meter(i).exchanges();
    run.Add(gases.meter(i).TotalEnergy() / gases.EnergyAtStart(i) - 1);
  }
  return run;
}

double TotalEnergy(const GasState& state) { return GasMeter(EnergyGas(), state).TotalEnergy(); }

template <typename Gas>
GasState StateOf(const Gas& gas, double time) {
  GasState state;
  for (int64_t i = 0; i < EnergyGas().balls(); ++i) state.balls.push_back(gas.BallAt(i, time));
  for (int64_t i = 0; i < EnergyGas().pistons(); ++i) {
    state.pistons.push_back(gas.PistonAt(i, time));
  }
  return state;
}

template <typename Gas>
GasEnergyRun OfEvents(const char* name, double exchanges) {
  GasEnergyRun run = {.method = name, .promised = false};
  const double end = TimeOf(exchanges);
  for (const GasReplica& replica : EnergyReplicas()) {
    Gas gas(EnergyGas(), replica.state, {});
    bool has_escaped = false;
    while (!has_escaped && gas.NextTime() <= end) {
      const EventKind kind = gas.Step().kind;
      run.exchanges += kind == EventKind::kBallPiston;
      has_escaped = kind == EventKind::kEscape;
    }
    run.Add(TotalEnergy(StateOf(gas, end)) / TotalEnergy(replica.state) - 1);
  }
  return run;
}

}  // namespace

void GasEnergyRun::Add(double error) {
  errors.Add(error);
  worst = std::max(worst, ErrorSize(error));
}

bool HasTrend(const GasEnergyRun& run) {
  const double mean = std::fabs(run.errors.mean);
  // Written as a negation, so that a mean or a standard error that is not a number is a trend.
  return !(mean <= 4 * run.errors.StandardError().value_or(0) || mean <= kUlp);
}

bool LosesEnergy(const GasEnergyRun& run) {
  const double each = static_cast<double>(run.exchanges) / static_cast<double>(run.errors.count);
  return HasTrend(run) || !(run.worst <= kUlpsOfAWalk * kUlp * (1 + std::sqrt(each)));
}

std::vector<GasEnergyRun> GasEnergyRuns(double effort) {
  const auto exchanges = [effort](double full) { return std::max(full * effort, 100.0); };
  return {
      OfEngine("lanes", GasEngine::kLanes, exchanges(5e4)),
      OfEngine("reference", GasEngine::kReference, exchanges(5e4)),
      OfEngine("jump process", GasEngine::kJumps, exchanges(5e5)),
      OfEvents<TextbookGas<TextbookRule::kPositiveRoot>>("nearest root", exchanges(2e3)),
      OfEvents<TextbookGas<TextbookRule::kApproaching>>("approaching disc", exchanges(2e3)),
      OfEvents<FixedStepGasEvents>("fixed steps of 1e-3", exchanges(5e2)),
  };
}

}  // namespace ballpiston::stability
