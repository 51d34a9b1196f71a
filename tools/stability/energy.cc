#include "tools/stability/energy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/billiard/event_flow.h"
#include "core/gas/canonical_gas.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_run.h"
#include "core/sampling/invariant_measure.h"
#include "tools/flows/energy_error.h"
#include "tools/flows/fixed_step_flow.h"
#include "tools/flows/lane_balls.h"
#include "tools/flows/metered_gases.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/flows/paper.h"
#include "tools/flows/precise_flow.h"
#include "tools/flows/rounded_to.h"
#include "tools/stability/failures.h"
#include "tools/stability/markdown_table.h"
#include "tools/stability/starts.h"
#include "tools/stability/textbook_flow.h"

namespace ballpiston::stability {
namespace {

constexpr uint64_t kEnergySeed = 23;
constexpr uint64_t kBalls = 4;  // one vector of balls alone
constexpr uint64_t kPairs = 48;

PairGeometry EnergyPair() { return *PairGeometry::Create(kPaperRho, 0.1); }

PairState StartOfPair(uint64_t orbit) {
  CounterRandom random(kEnergySeed, 0, orbit);
  return DrawFromCollisionMeasure(EnergyPair(), random);
}

double Share(uint64_t part, uint64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

// Balls alone, checked every thousand flights.
template <FlyLanes& fly>
EnergyRecord BallsInLanes(uint64_t hits) {
  constexpr uint64_t kBetweenLooks = 1000;
  std::vector<PairState> starts;
  for (uint64_t i = 0; i < kBalls; ++i) {
    CounterRandom random(kEnergySeed, 1, i);
    starts.push_back(AnywhereOnWall(EnergyPair(), random));
  }
  std::vector<LaneFrame> balls = OnTheirWalls(starts);
  std::vector<LaneHit> last(balls.size());
  EnergyRecord record;
  for (uint64_t done = 0; done < hits; done += kBetweenLooks) {
    fly(EnergyPair(), balls, kBetweenLooks, last);
    for (size_t i = 0; i < balls.size(); ++i) {
      balls[i] = last[i].frame;
      record.Add(Share(done, hits), SignedEnergyError(balls[i]));
    }
  }
  return record;
}

// Pairs in equilibrium, checked at every collision.
class PairsInEquilibrium : public NumberedOrbits {
 public:
  explicit PairsInEquilibrium(uint64_t hits_each) : hits_each_(hits_each), hits_(kPairs, 0) {}

  PairState Start(uint64_t orbit) override { return StartOfPair(orbit); }
  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    hits_[orbit] += collision.ball_wall_hits;
    record_.Add(std::min(Share(hits_[orbit], hits_each_), 1.0), SignedEnergyError(collision.state));
    const bool on = !collision.escaped && hits_[orbit] < hits_each_;
    return on ? AfterCollision::kGoOn : AfterCollision::kEnd;
  }

  const EnergyRecord& record() const { return record_; }

 private:
  uint64_t hits_each_;
  std::vector<uint64_t> hits_;
  EnergyRecord record_;
};

template <Engine engine>
EnergyRecord PairsByEngine(uint64_t hits) {
  PairsInEquilibrium pairs(hits / kPairs);
  RunOrbits(engine, EnergyPair(), kPairs, pairs);
  return pairs.record();
}

// One pair, event by event.
template <typename Flow>
EnergyRecord PairByEvents(uint64_t hits) {
  EnergyRecord record;
  Flow flow(EnergyPair(), RoundedTo<RealOf<Flow>>(StartOfPair(0)));
  for (uint64_t done = 0; done < hits;) {
    const EventKind kind = flow.Step().kind;
    if (kind == EventKind::kEscape) break;
    done += kind == EventKind::kBallWall;
    if (kind != EventKind::kBallPiston) continue;
    flow.ExchangeComponents();
    record.Add(Share(done, hits), SignedEnergyError(flow.state()));
  }
  return record;
}

// ---- gases ----

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
          .what = "gases of 4x3 cells",
          .orbits = kGases,
          .hits = record.exchanges(),
          .promised = true,
          .worst = record.Worst(),
          .permitted = record.LongestWalk(),
          .change = record.Mean()};
}

}  // namespace

bool EnergyChange::IsTrend() const {
  const double size = std::fabs(value);
  // Written as a negation, so that a number that is not a number is a trend.
  return !(size <= 4 * error || size <= std::numeric_limits<double>::epsilon());
}

void EnergyRecord::Add(double share_of_run, double error) {
  const auto place = static_cast<size_t>(share_of_run * kStretches);
  Stretch& stretch = stretches_[std::min(place, kStretches - 1)];
  ++stretch.count;
  stretch.sum += error;
  worst_ = std::max(worst_, ErrorSize(error));
}

EnergyChange EnergyRecord::Drift() const {
  // From -1/2 to 1/2, with the mean 0.
  const auto x = [](size_t i) { return (static_cast<double>(i) + 0.5) / kStretches - 0.5; };
  double sum = 0, xy = 0, xx = 0, squares = 0;
  for (size_t i = 0; i < kStretches; ++i) {
    sum += stretches_[i].Mean();
    xy += x(i) * stretches_[i].Mean();
    xx += x(i) * x(i);
  }
  for (size_t i = 0; i < kStretches; ++i) {
    const double residual = stretches_[i].Mean() - sum / kStretches - xy / xx * x(i);
    squares += residual * residual;
  }
  return {xy / xx, std::sqrt(squares / (kStretches - 2) / xx)};
}

std::vector<EnergyRun> EnergyRuns(double effort) {
  using enum TextbookRule;
  constexpr double kPermitted = 1e-14;
  std::vector<EnergyRun> runs;
  const auto add = [&](const char* what, uint64_t orbits, const char* method, bool promised,
                       double full, EnergyRecord (*run)(uint64_t hits)) {
    const auto hits = std::max<uint64_t>(static_cast<uint64_t>(full * effort), 20'000);
    const EnergyRecord record = run(hits);
    runs.push_back(
        {method, what, orbits, hits, promised, record.Worst(), kPermitted, record.Drift()});
  };
  add("ball alone, u^2", kBalls, "lanes", true, 1e9, BallsInLanes<FlyLaneBalls>);
  add("ball alone, u^2", kBalls, "lanes, single", false, 1e9, BallsInLanes<FlyLaneBallsSingle>);
  add("pairs", kPairs, "lanes", true, 1e9, PairsByEngine<Engine::kLanes>);
  add("pairs", kPairs, "lanes, single", false, 1e9, PairsByEngine<Engine::kLanesSingle>);
  const auto pair = [&](const char* method, bool promised, double full,
                        EnergyRecord (*run)(uint64_t)) {
    add("one pair", 1, method, promised, full, run);
  };
  pair("reference", true, 1e9, PairByEvents<ReferenceFlow>);
  pair("reference, single", false, 1e8, PairByEvents<EventFlow<float>>);
  pair("reference, 64 bits", true, 1e7, PairByEvents<EventFlow<long double>>);
  pair("reference, 113 bits", true, 1e6, PairByEvents<EventFlow<Quad>>);
  pair("nearest root", false, 1e8, PairByEvents<TextbookFlow<kPositiveRoot>>);
  pair("approaching disc", false, 1e8, PairByEvents<TextbookFlow<kApproaching>>);
  pair("fixed steps of 1e-3", false, 1e6, PairByEvents<FixedStepFlow>);
  const auto gases = [&](const char* method, GasEngine engine, double exchanges) {
    runs.push_back(OfEngine(method, engine, std::max(exchanges * effort, 100.0)));
  };
  gases("lanes", GasEngine::kLanes, 5e4);
  gases("reference", GasEngine::kReference, 5e4);
  gases("jump process", GasEngine::kJumps, 5e5);
  return runs;
}

void GasEnergyRecord::Add(uint64_t exchanges, double error) {
  exchanges_ += exchanges;
  errors_.Add(error);
  worst_ = std::max(worst_, ErrorSize(error));
}

double GasEnergyRecord::LongestWalk() const {
  const double each = static_cast<double>(exchanges_) / static_cast<double>(errors_.count);
  return 4 * std::numeric_limits<double>::epsilon() * (1 + std::sqrt(each));
}

std::string EnergyTable(const std::vector<EnergyRun>& runs) {
  MarkdownTable table({"method", "what", "orbits", "hits on walls, of gases on pistons",
                       "worst dE/E", "drift, of gases mean dE/E at the end", "its standard error",
                       "a trend"});
  for (const EnergyRun& run : runs) {
    table.Add({run.method, run.what, CountText(run.orbits), CountText(run.hits),
               ErrorText(run.worst), SignedText(run.change.value), ErrorText(run.change.error),
               YesOrNo(run.change.IsTrend())});
  }
  return table.Text(2);
}

}  // namespace ballpiston::stability
