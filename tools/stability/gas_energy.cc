#include "tools/stability/gas_energy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_run.h"
#include "core/geometry/paper.h"
#include "tools/flows/metered_gases.h"
#include "tools/stability/energy_drift.h"
#include "tools/stability/failures.h"
#include "tools/stability/fixed_step_events.h"
#include "tools/stability/markdown_table.h"
#include "tools/stability/textbook_gas.h"

namespace ballpiston::stability {
namespace {

constexpr uint64_t kGasEnergySeed = 25;
constexpr uint64_t kGases = 48;

GasGeometry EnergyGas() {
  return *GasGeometry::Create(kPaperRho, 0.2, *ParseGasShape("4x3"), GasEnds::kPeriodic);
}

std::vector<GasStart> EnergyStarts() {
  std::vector<GasStart> starts;
  for (uint64_t i = 0; i < kGases; ++i) {
    const GasRandom random(kGasEnergySeed, 0, i);
    CounterRandom of_start = random.OfStart();
    starts.push_back({DrawGas(EnergyGas(), TemperatureProfile(1), of_start), {}, random, nullptr});
  }
  return starts;
}

// The time in which each gas has about this number of exchanges.
double TimeOf(double exchanges) {
  const GasGeometry gas = EnergyGas();
  return exchanges / (static_cast<double>(gas.contacts()) * GasExchangeRate(gas, 1));
}

double TotalEnergy(const GasState& state) { return GasMeter(EnergyGas(), state).TotalEnergy(); }

GasEnergyRun OfEngine(const char* name, GasEngine engine, double exchanges) {
  GasEnergyRun run = {.method = name, .promised = true};
  const std::vector<GasStart> starts = EnergyStarts();
  MeteredGases gases(engine, EnergyGas(), starts);
  gases.AdvanceTo(TimeOf(exchanges));
  for (size_t i = 0; i < starts.size(); ++i) {
    run.exchanges += gases.meters()[i].exchanges();
    run.Add(gases.meters()[i].TotalEnergy() / TotalEnergy(starts[i].state) - 1);
  }
  return run;
}

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
  for (const GasStart& start : EnergyStarts()) {
    Gas gas(EnergyGas(), start.state, {});
    bool has_escaped = false;
    while (!has_escaped && gas.NextTime() <= end) {
      const EventKind kind = gas.Step().kind;
      run.exchanges += kind == EventKind::kBallPiston;
      has_escaped = kind == EventKind::kEscape;
    }
    run.Add(TotalEnergy(StateOf(gas, end)) / TotalEnergy(start.state) - 1);
  }
  return run;
}

}  // namespace

void GasEnergyRun::Add(double error) {
  errors.Add(error);
  worst = std::max(worst, ErrorSize(error));
}

bool HasTrend(const GasEnergyRun& run) {
  return IsTrend(run.errors.mean, run.errors.StandardError().value_or(0));
}

bool LosesEnergy(const GasEnergyRun& run) {
  constexpr double kUlp = std::numeric_limits<double>::epsilon();
  const double each = static_cast<double>(run.exchanges) / static_cast<double>(run.errors.count);
  return HasTrend(run) || !(run.worst <= kUlpsOfAWalk * kUlp * (1 + std::sqrt(each)));
}

std::vector<GasEnergyRun> GasEnergyRuns(double effort) {
  using enum TextbookRule;
  const auto exchanges = [effort](double full) { return std::max(full * effort, 100.0); };
  return {
      OfEngine("lanes", GasEngine::kLanes, exchanges(5e4)),
      OfEngine("reference", GasEngine::kReference, exchanges(5e4)),
      OfEngine("jump process", GasEngine::kJumps, exchanges(5e5)),
      OfEvents<TextbookGas<kPositiveRoot>>("nearest root", exchanges(2e3)),
      OfEvents<TextbookGas<kApproaching>>("approaching disc", exchanges(2e3)),
      OfEvents<FixedStepGasEvents>("fixed steps of 1e-3", exchanges(5e2)),
  };
}

std::string GasEnergyTable(const std::vector<GasEnergyRun>& runs) {
  MarkdownTable table({"method", "gases", "piston hits", "worst dE/E", "mean at the end",
                       "its standard error", "a trend"});
  for (const GasEnergyRun& run : runs) {
    table.Add({run.method, CountText(run.errors.count), CountText(run.exchanges),
               ErrorText(run.worst), SignedText(run.errors.mean),
               ErrorText(run.errors.StandardError().value_or(0)), YesOrNo(HasTrend(run))});
  }
  return table.Text(1);
}

}  // namespace ballpiston::stability
