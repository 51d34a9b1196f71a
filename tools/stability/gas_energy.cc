#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_run.h"
#include "tools/flows/metered_gases.h"
#include "tools/flows/paper.h"
#include "tools/stability/energy.h"
#include "tools/stability/failures.h"
#include "tools/stability/markdown_table.h"

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

EnergyRun OfEngine(const char* method, GasEngine engine, double exchanges) {
  GasEnergyRecord record;
  const std::vector<GasStart> starts = EnergyStarts();
  MeteredGases gases(engine, EnergyGas(), starts);
  gases.AdvanceTo(TimeOf(exchanges));
  for (size_t i = 0; i < starts.size(); ++i) {
    const GasMeter& meter = gases.meters()[i];
    record.Add(meter.exchanges(), meter.TotalEnergy() / TotalEnergy(starts[i].state) - 1);
  }
  return {.method = method,
          .what = "gases",
          .orbits = kGases,
          .hits = record.exchanges(),
          .promised = true,
          .worst = record.Worst(),
          .permitted = record.LongestWalk(),
          .change = record.Mean()};
}

}  // namespace

void GasEnergyRecord::Add(uint64_t exchanges, double error) {
  exchanges_ += exchanges;
  errors_.Add(error);
  worst_ = std::max(worst_, ErrorSize(error));
}

double GasEnergyRecord::LongestWalk() const {
  const double each = static_cast<double>(exchanges_) / static_cast<double>(errors_.count);
  return 4 * std::numeric_limits<double>::epsilon() * (1 + std::sqrt(each));
}

std::vector<EnergyRun> GasEnergyRuns(double effort) {
  const auto exchanges = [effort](double full) { return std::max(full * effort, 100.0); };
  return {
      OfEngine("lanes", GasEngine::kLanes, exchanges(5e4)),
      OfEngine("reference", GasEngine::kReference, exchanges(5e4)),
      OfEngine("jump process", GasEngine::kJumps, exchanges(5e5)),
  };
}

std::string GasEnergyTable(const std::vector<EnergyRun>& runs) {
  MarkdownTable table({"method", "gases", "piston hits", "worst dE/E", "mean at the end",
                       "its standard error", "a trend"});
  for (const EnergyRun& run : runs) {
    table.Add({run.method, CountText(run.orbits), CountText(run.hits), ErrorText(run.worst),
               SignedText(run.change.value), ErrorText(run.change.error),
               YesOrNo(run.change.IsTrend())});
  }
  return table.Text(1);
}

}  // namespace ballpiston::stability
