// The checks of gases find planted failures: a watch receives changed events of the reference gas,
// or an engine's reading is changed.
#include "core/gas/canonical_gas.h"
#include "core/gas/reference_gas.h"
#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"
#include "tools/flows/metered_gases.h"
#include "tools/stability/energy.h"
#include "tools/stability/gas_watch.h"

namespace ballpiston::stability {
namespace {

GasGeometry Ring() { return GasOf(kPaperRho, 0.2, "3"); }
GasGeometry Chain() { return GasOf(kPaperRho, 0.2, "3", GasEnds::kReservoirs); }

GasStart AReplica(const GasGeometry& geometry) {
  const GasRandom random(91, 0, 0);
  return {GasInEquilibrium(geometry, 1, 92, 0), ThermalWalls(geometry, 2, 1, random), random,
          nullptr};
}

// Changes an event before the watch receives it. If the change returns false, the event is omitted.
struct Told {
  GasEvent event;
  GasBall ball;
  GasPiston piston;
};
using Change = std::function<bool(Told& told)>;

struct WatchedGas {
  Failures failures;
  double energy_error = 0;
};

WatchedGas WatchGas(const GasGeometry& geometry, const Change& change, int events = 2000) {
  const GasStart replica = AReplica(geometry);
  ReferenceGas gas(geometry, replica.state, replica.walls);
  GasWatch watch(geometry, replica.state, replica.walls, std::numeric_limits<double>::epsilon());
  WatchedGas watched;
  bool goes_on = true;
  for (int i = 0; goes_on && i < events; ++i) {
    const GasEvent event = gas.Step();
    Told told = {event, gas.BallAt(std::max<int64_t>(event.ball, 0), event.time),
                 gas.PistonAt(std::max<int64_t>(event.piston, 0), event.time)};
    if (change(told)) goes_on = watch.See(told.event, told.ball, told.piston, watched.failures);
  }
  watched.energy_error = watch.EnergyError();
  return watched;
}

bool IsTold(EventKind kind, const Told& told) { return told.event.kind == kind; }

TEST(GasDetectors, UnchangedEventsGiveNoFailure) {
  for (const GasGeometry& geometry : {Ring(), Chain()}) {
    const WatchedGas watched = WatchGas(geometry, [](Told&) { return true; });
    EXPECT_GT(watched.failures.hits, 30u);
    EXPECT_EQ(watched.failures.Total(), 0u);
    EXPECT_LT(watched.energy_error, 1e-14);
  }
}

struct PlantedInGas {
  const char* what;
  Change change;
  int events;
  uint64_t Failures::*counted;
  bool only_one = true;  // then the watch ends
};

TEST(GasDetectors, PlantedFailuresAreCounted) {
  const auto turned_at = [](EventKind kind) {
    return [kind](Told& told) {
      if (IsTold(kind, told)) told.ball.direction = -told.ball.direction;
      return kind == EventKind::kBallPiston || IsTold(kind, told);
    };
  };
  const auto at_height = [](double y) {
    return [y](Told& told) {
      told.ball.position.y() = y;
      return IsTold(EventKind::kBallWall, told);
    };
  };
  int told_before = 0;
  const std::vector<PlantedInGas> all = {
      {"an omitted exchange", [](Told& told) { return !IsTold(EventKind::kBallPiston, told); },
       2000, &Failures::missed},
      {"a piston that turns late",
       [](Told& told) {
         if (IsTold(EventKind::kPistonWall, told)) told.event.time += 1e-9;
         return true;
       },
       50, &Failures::beyond_walls, false},
      {"a time before the last one",
       [&](Told& told) {
         if (++told_before == 100) told.event.time -= 1e-3 + told.event.time / 2;
         return told_before <= 100;
       },
       2000, &Failures::negative_times},
      {"a ball that still approaches its piston", turned_at(EventKind::kBallPiston), 300,
       &Failures::inward, false},
      {"a ball that flies into its wall", turned_at(EventKind::kBallWall), 100, &Failures::inward,
       false},
      {"an escape that is reported",
       [](Told& told) {
         told.event.kind = EventKind::kEscape;
         return true;
       },
       2000, &Failures::escapes},
      {"a ball outside its cell", at_height(0.4), 2000, &Failures::escapes},
      {"a ball nowhere", at_height(NAN), 2000, &Failures::escapes},
  };
  for (const PlantedInGas& planted : all) {
    const uint64_t count =
        WatchGas(Ring(), planted.change, planted.events).failures.*planted.counted;
    EXPECT_TRUE(count == 1 || (count > 0 && !planted.only_one)) << planted.what << " " << count;
  }
}

TEST(GasDetectors, ABallThatStandsStillIsALoop) {
  const GasStart replica = AReplica(Ring());
  GasWatch watch(Ring(), replica.state, replica.walls, std::numeric_limits<double>::epsilon());
  ReferenceGas gas(Ring(), replica.state, replica.walls);
  GasEvent hit = gas.Step();
  while (hit.kind != EventKind::kBallWall) hit = gas.Step();
  Failures failures;
  int told = 0;
  while (watch.See(hit, gas.BallAt(hit.ball, hit.time), {}, failures)) ASSERT_LT(++told, 200);
  EXPECT_EQ(failures.loops, 1u);
  EXPECT_GT(told, 50);
}

TEST(GasDetectors, AddedEnergyIsAnError) {
  const WatchedGas watched = WatchGas(Ring(), [](Told& told) {
    told.ball.speed *= 1 + 1e-9;
    return true;
  });
  EXPECT_GT(watched.energy_error, 1e-10);
}

// A reading of each of several gases, after a few flights.
class GasLookBack : public ::testing::Test {
 protected:
  static constexpr double kTime = 1.5;

  Failures Look(const std::function<void(GasReading&)>& change) const {
    Failures failures;
    for (uint64_t i = 0; i < 50; ++i) {
      const GasRandom random(93, 0, i);
      const GasStart replica = {GasInEquilibrium(Ring(), 1, 94, i), {}, random, nullptr};
      MeteredGases gases(GasEngine::kLanes, Ring(), {replica});
      gases.AdvanceTo(kTime);
      GasReading reading = ReadingOf(gases.meters().front());
      if (reading.exchanges == 0) continue;
      change(reading);
      failures.Merge(LookBack(Ring(), replica, kTime, reading));
    }
    return failures;
  }
};

TEST_F(GasLookBack, ChangedReadingsAreMissedOrPhantoms) {
  const auto swap = [](GasReading& reading) {
    std::swap(reading.energies[0], reading.energies[1]);
  };
  const Failures unchanged = Look([](GasReading&) {});
  EXPECT_GT(unchanged.looked_back, 20u);
  EXPECT_EQ(unchanged.Total(), 0u);
  const Failures too_few = Look([&](GasReading& reading) {
    --reading.exchanges;
    swap(reading);
  });
  EXPECT_GT(too_few.missed, 20u);
  EXPECT_EQ(too_few.phantoms, 0u);
  const Failures swapped = Look(swap);
  EXPECT_GT(swapped.phantoms, 20u);
  EXPECT_EQ(swapped.missed, 0u);
  EXPECT_GT(Look([](GasReading& reading) { reading.energies[0] = NAN; }).phantoms, 20u);
}

TEST(GasDetectors, ANegativeInfiniteOrNanEnergyIsAnEscape) {
  const GasState state = AReplica(Ring()).state;
  const double start = GasMeter(Ring(), state).TotalEnergy();
  for (const double energy : {-1.0, std::nan(""), HUGE_VAL}) {
    GasMeter meter(Ring(), state);
    EXPECT_EQ(LookAtEnergies(Ring(), meter, start).Total(), 0u);
    meter.SetPiston(1, 0, energy);
    EXPECT_EQ(LookAtEnergies(Ring(), meter, start).escapes, 1u);
  }
}

TEST(GasDetectors, OnlyAGasWithoutThermalWallsReportsItsEnergyError) {
  for (const GasGeometry& geometry : {Ring(), Chain()}) {
    GasMeter meter(geometry, AReplica(geometry).state);
    const double start = meter.TotalEnergy();
    meter.SetPiston(1, 1, 2 * meter.Energy(meter.balls() + 1));
    const double error = LookAtEnergies(geometry, meter, start).energy;
    if (geometry.ends() == GasEnds::kReservoirs) {
      EXPECT_TRUE(std::isnan(error));
    } else {
      EXPECT_GT(error, 1e-6);
    }
  }
}

GasEnergyRecord RecordWithErrors(double mean, double scatter) {
  GasEnergyRecord record;
  for (const int sign : {-1, 1, -1, 1}) record.Add(10'000, mean + sign * scatter);
  return record;
}

bool LosesEnergy(const GasEnergyRecord& record) {
  const EnergyRun run = {.method = "lanes",
                         .what = "gases",
                         .orbits = 4,
                         .hits = record.exchanges(),
                         .promised = true,
                         .worst = record.Worst(),
                         .permitted = record.LongestWalk(),
                         .change = record.Mean()};
  return run.LosesEnergy();
}

// 1e4 exchanges each: a random walk of ulps reaches about 2e-14.
TEST(GasDetectors, ALossOfEnergyIsATrendOrMoreThanAWalk) {
  EXPECT_FALSE(LosesEnergy(RecordWithErrors(0, 2e-14)));
  EXPECT_FALSE(RecordWithErrors(1e-14, 2e-14).Mean().IsTrend());
  EXPECT_TRUE(RecordWithErrors(2e-14, 1e-15).Mean().IsTrend());
  EXPECT_TRUE(LosesEnergy(RecordWithErrors(2e-14, 1e-15)));
  EXPECT_TRUE(LosesEnergy(RecordWithErrors(0, 1e-12)));
}

TEST(GasDetectors, AnEnergyErrorThatIsNotANumberIsATrendAndTheWorstError) {
  for (const double error : {std::nan(""), HUGE_VAL}) {
    GasEnergyRecord record = RecordWithErrors(0, 1e-15);
    record.Add(10'000, error);
    record.Add(10'000, 1e-15);
    EXPECT_EQ(record.Worst(), HUGE_VAL);
    EXPECT_TRUE(record.Mean().IsTrend());
    EXPECT_TRUE(LosesEnergy(record));
  }
}

TEST(GasDetectors, LaneGasesShowNoFailure) {
  const std::vector<GasStart> starts(50, AReplica(Ring()));
  const Failures failures = RunGasesByMeters<GasEngine::kLanes>(Ring(), starts, 30);
  EXPECT_EQ(failures.orbits, 50u);
  EXPECT_GT(failures.hits, 50u);
  EXPECT_EQ(failures.Total(), 0u);
}

TEST(GasDetectors, LaneGasesThatTakeTooManyCallsAreALoop) {
  const std::vector<GasStart> starts(50, AReplica(Ring()));
  const Failures endless = RunGasesByMeters<GasEngine::kLanes, 0>(Ring(), starts, 1'000'000);
  EXPECT_EQ(endless.orbits, 50u);
  EXPECT_EQ(endless.loops, 1u);
}

}  // namespace
}  // namespace ballpiston::stability
