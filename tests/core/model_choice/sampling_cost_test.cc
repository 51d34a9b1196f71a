#include "core/model_choice/sampling_cost.h"

#include "core/experiment/energy_relaxation.h"
#include "core/experiment/expected_returns.h"
#include "tests/core/model_choice/questions.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

// ---- errors, which are measured ----

struct Case {
  const char* questions;
  // Bound of stated/measured: above the measured ratio by five standard errors of a measured error,
  // which are up to 40 % with 80 orbits. So a false alarm has a probability below 1e-5.
  double factor;
};

constexpr Case kCasesOfErrors[] = {
    {"equilibrium collisions=10000 delta={0.05|0.15|0.32}", 1.2},
    {"{conditional-mean-free-time|first-hit} samples=10000 delta=0.05 epsilon={0.125|0.3|0.45}",
     1.15},
    {"{conditional-mean-free-time|first-hit} samples=10000 delta=0.2 epsilon={0.125|0.3|0.45}",
     1.7},
    {"lyapunov collisions=5000 model=billiard {rho=0.501 delta=0.4|rho=0.53 delta=0.3|"
     "rho=0.53 delta=0.02|rho=0.7 delta=0.01|rho=0.706 delta=0.0014|rho=0.706 delta=2e-4} "
     "estimate={lyapunov_1|lyapunov_2|entropy|lyapunov_1_per_collision|lyapunov_2_per_collision}",
     2.2},
    {"gas-lyapunov samples=100 model=billiard {cells=1 rho=0.51 delta=0.2|cells=4 delta=0.2|"
     "cells=2x2 rho=0.65 delta=0.04} estimate={lyapunov_1|entropy_per_ball}",
     1.6},
    // Predicted is the error of the jump process. The billiard at delta = 0.25, epsilon = 0.05 has
    // 1.95 times that error, give or take 0.1 from seed to seed.
    {"energy-relaxation samples=10000 model=billiard delta=0.1{| epsilon=0.01| epsilon=0.05| "
     "epsilon=0.4}",
     1.25},
    {"energy-relaxation samples=10000 model=billiard delta=0.25{| epsilon=0.01| epsilon=0.05| "
     "epsilon=0.4}",
     2.5},
    {"energy-relaxation samples=10000 model=markov delta={0.1|0.25}{| epsilon=0.01| epsilon=0.05| "
     "epsilon=0.4}",
     1.4},
    // Where the piston or the ball rests or is slow, few orbits meet. At a small delta too few meet
    // a body at rest to give an error. delta is 0.999 or 0.1 of its bound.
    {"energy-relaxation samples=2048 model=billiard {rho=0.51 delta=0.3991|rho=0.66 delta=0.0691} "
     "epsilon={0|1e-4|0.5}",
     1.6},
    {"energy-relaxation samples=2048 model=billiard rho=0.51 delta=0.03995 epsilon={0|1e-4}", 1.6},
    {"energy-relaxation samples=2048 model=billiard rho=0.66 delta=0.00692 epsilon=1e-4", 1.6},
    {"energy-relaxation samples=2048 model=billiard {rho=0.51 delta=0.3991|rho=0.51 delta=0.03995|"
     "rho=0.66 delta=0.0691|rho=0.66 delta=0.00692} epsilon=0.4999",
     3.5},
    // The return time to a ball at rest depends only on the ball's place, which is known.
    {"conditional-mean-free-time samples=4096 model=billiard epsilon=0.5 {rho=0.51 delta=0.3987|"
     "rho=0.51 delta=0.003995|rho=0.66 delta=0.06905|rho=0.66 delta=0.000692}",
     1.3},
    // A slow piston at the cold end passes the current in few portions.
    {"gas-conduction samples=256 model=billiard_reference cells=1 hot=1 cold={0.5|0.01|1e-4|1e-6}",
     2},
};

TEST(SamplingCost, PredictedErrorsAreThoseMeasured) {
  for (const auto& [questions, factor] : kCasesOfErrors) {
    for (const std::string& question : QuestionsOf(questions)) {
      const double ratio = StatedOverMeasured(Asked(question));
      EXPECT_LT(ratio, factor) << question;
      EXPECT_GT(ratio, 1 / factor) << question;
    }
  }
  const EnsembleSpec infinite = Asked("conditional-mean-free-time epsilon=0");
  EXPECT_TRUE(std::isinf(ScatterOf(infinite, PointAt(infinite, 0)).error));
}

// ---- costs, which follow from counts and a machine's rates ----

MachineRates OnlyOf(double EngineRate::*part) {
  MachineRates rates;
  rates.lanes.*part = 1;
  return rates;
}

double Cost(const EnsembleSpec& spec, const MachineRates& rates) {
  return CostOfSampling(spec, PointAt(spec, 0), rates).sample;
}

TEST(SamplingCost, CostIsTheSumOverEvents) {
  const PairGeometry geometry = PaperGeometry(0.1);
  const double hits = HitsPerCollision(geometry).ball_wall;
  const EnsembleSpec collision = Asked("equilibrium"), orbit = Asked("energy-relaxation");
  EXPECT_DOUBLE_EQ(Cost(collision, OnlyOf(&EngineRate::wall_hit)), hits);
  EXPECT_DOUBLE_EQ(Cost(collision, OnlyOf(&EngineRate::collision)), 1);
  EXPECT_EQ(Cost(collision, OnlyOf(&EngineRate::sample)), 0);
  MachineRates reference;  // which has an event for each hit and for each collision
  reference.reference.wall_hit = 1;
  EXPECT_GE(Cost(Asked("equilibrium model=billiard_reference"), reference), hits + 1);
  const double collisions = CollisionsPerOrbit(PointAt(orbit, 0));
  EXPECT_DOUBLE_EQ(Cost(orbit, OnlyOf(&EngineRate::wall_hit)), hits * collisions);
  EXPECT_DOUBLE_EQ(Cost(orbit, OnlyOf(&EngineRate::collision)), collisions);
  const EnsembleSpec returns = Asked("conditional-mean-free-time");
  EXPECT_DOUBLE_EQ(Cost(returns, OnlyOf(&EngineRate::wall_hit)),
                   HitsPerReturn(geometry, 0.125).ball_wall);
  EXPECT_DOUBLE_EQ(Cost(returns, OnlyOf(&EngineRate::sample)), 1);
  const EnsembleSpec gas = Asked("gas-conduction model=billiard");
  EXPECT_DOUBLE_EQ(Cost(gas, OnlyOf(&EngineRate::collision)),
                   ForecastOf(gas, PointAt(gas, 0)).collisions);
  MachineRates jumps;
  jumps.jump = 1;
  for (const char* delta : {"0.3", "1e-3"}) {
    const std::string walk = absl::StrCat("energy-relaxation model=markov delta=", delta);
    EXPECT_EQ(Cost(Asked(walk), jumps), kOriginTimes + kWindowTimes);
    EXPECT_EQ(Cost(Asked(walk + " epsilon=0.4"), jumps), kWindowTimes);
  }
}

TEST(SamplingCost, CostIsThatOfTheEngineInUse) {
  const MachineRates rates = SomeMachine().rates;
  const double lanes = Cost(Asked("equilibrium"), rates);
  EXPECT_LT(Cost(Asked("equilibrium precision=single"), rates), lanes);
  EXPECT_GT(Cost(Asked("equilibrium model=billiard_reference"), rates), 5 * lanes);
  // A ball that hardly moves hits no wall before it is met, and few such balls are.
  for (const std::string model : {"billiard", "billiard_reference"}) {
    MachineRates hits;
    hits.lanes.wall_hit = hits.reference.wall_hit = 1;
    const std::string relaxation = "energy-relaxation delta=0.02 model=" + model;
    const double slow = Cost(Asked(relaxation + " epsilon=0.499999999999"), hits);
    EXPECT_LT(slow, 0.5 * Cost(Asked(relaxation + " epsilon=0.3"), hits));
    EXPECT_GT(slow, 0);
  }
}

// 24 lanes, and a wall hit takes 1 s.
SamplingCost InLanes(const EnsembleSpec& spec) {
  MachineRates rates;
  rates.lanes = {.wall_hit = 1, .lanes = 24};
  rates.reference = {.wall_hit = 1, .collision = 1, .sample = 1};
  return CostOfSampling(spec, PointAt(spec, 0), rates);
}

// Measured: 3.4 s were predicted for one collision at delta = 3e-5, and it took 39 s.
TEST(SamplingCost, AFewSamplesCostAsMuchAsTheLongestInAllLanes) {
  const SamplingCost cost = InLanes(Asked("equilibrium delta=1e-4"));
  EXPECT_DOUBLE_EQ(cost.Of(1, 1), 24 * cost.sample);
  EXPECT_DOUBLE_EQ(cost.Of(1, 8), cost.Of(1, 1));
  EXPECT_NEAR(cost.Of(2, 1), 1.5 * 24 * cost.sample, 0.5 * cost.sample);
  EXPECT_NEAR(cost.Of(24, 1), 3.776 * 24 * cost.sample, 0.1 * cost.sample);  // 1 + ... + 1/24
  for (const int threads : {1, 4}) {
    EXPECT_NEAR(cost.Of(1e6, threads) / (1e6 * cost.sample), 1, 1e-3);
  }
  EXPECT_EQ(cost.ThreadsFor(24, 8), 1);
  EXPECT_EQ(cost.ThreadsFor(25, 8), 2);
  EXPECT_EQ(cost.ThreadsFor(1e6, 8), 8);
  // Orbits of 40 collisions have nearly equal durations.
  const SamplingCost orbits = InLanes(Asked("energy-relaxation delta=1e-4"));
  EXPECT_NEAR(orbits.Of(24, 1) / (24 * orbits.sample), 1.44, 0.02);
  // The samples of one orbit fly one after the other: markov-property has up to 32.
  const SamplingCost exchanges = InLanes(Asked("markov-property delta=1e-4"));
  EXPECT_DOUBLE_EQ(exchanges.Of(1, 1), 24 * exchanges.sample);
  EXPECT_DOUBLE_EQ(exchanges.Of(32, 1), 24 * 32 * exchanges.sample);
  EXPECT_DOUBLE_EQ(exchanges.first, exchanges.Of(32, 1));
  EXPECT_EQ(exchanges.ThreadsFor(24 * 32, 8), 1);
  EXPECT_EQ(exchanges.ThreadsFor(24 * 32 + 1, 8), 2);
  // A reference orbit costs the same alone.
  const SamplingCost alone = InLanes(Asked("equilibrium delta=1e-3 model=billiard_reference"));
  EXPECT_DOUBLE_EQ(alone.Of(1, 1), alone.sample);
  EXPECT_DOUBLE_EQ(alone.Of(100, 1), 100 * alone.sample);
  // A thread takes at most a quarter of a chunk's 64 replicas, or one of more than a minute.
  const std::string gas = "gas-equilibrium cells=3 model=billiard delta=";
  const EnsembleSpec quick = Asked(gas + "0.2"), slow = Asked(gas + "1e-6");
  EXPECT_EQ(CostOfSampling(quick, PointAt(quick, 0), {}).lanes, 16);
  EXPECT_EQ(CostOfSampling(slow, PointAt(slow, 0), {}).lanes, 1);
}

TEST(SamplingCost, IncludesTheWarmUpOfAllTrajectories) {
  const EnsembleSpec steady = Asked("gas-conduction cells=3 delta=0.2 model=billiard");
  const Trajectories trajectories = *ForecastOf(steady, PointAt(steady, 0)).trajectories;
  const auto warm_up = static_cast<double>(trajectories.count() * trajectories.warm_up);
  const SamplingCost cost = InLanes(steady);
  EXPECT_DOUBLE_EQ(cost.Of(1000, 1), (warm_up + 1000) * cost.sample);
}

TEST(SamplingCost, SamplesInATimeTakeThisTime) {
  for (const char* question : {"equilibrium delta=1e-4", "equilibrium delta=0.1"}) {
    const SamplingCost cost = InLanes(Asked(question));
    for (const int threads : {1, 4}) {
      EXPECT_EQ(cost.SamplesIn(0.99 * threads * cost.first, threads), 0);
      for (const double factor : {1.01, 3.0, 100.0, 1e5}) {
        const double seconds = factor * threads * cost.first;
        const double samples = cost.SamplesIn(seconds, threads);
        EXPECT_GE(samples, 1);
        EXPECT_LE(cost.Of(samples, threads), seconds * (1 + 1e-6));
        EXPECT_GT(cost.Of(samples + 1.01, threads), seconds * (1 - 1e-6));
      }
    }
  }
}

// Seconds of a replica, measured on one machine together with its rates.
TEST(SamplingCost, GasesOfFrequentVisitsAndLargeGasesCostMore) {
  MachineRates rates;
  rates.lanes = {.wall_hit = 1.78e-9, .collision = 1.22e-7, .sample = 3.26e-7};
  struct Measured {
    double rho, delta;
    int columns;
    double seconds;
  };
  for (const Measured& row : {Measured{0.501, 0.322, 10, 1.17e-4},
                              {0.53, 0.1989, 10, 1.14e-4},
                              {0.53, 0.0199, 10, 1.38e-3},
                              {0.6, 0.0926, 10, 1.41e-4},
                              {0.68, 0.01996, 10, 3.12e-4},
                              {0.704, 0.0022065, 10, 1.69e-3},
                              {0.70705, 4.0153e-5, 10, 0.0842},
                              {0.53, 0.1, 1000, 0.0279},
                              {0.53, 0.1, 100'000, 0.286},
                              {0.53, 0.1, 1'000'000, 3.68}}) {
    const double predicted = Cost(Asked(absl::StrCat("gas-equilibrium model=billiard rho=", row.rho,
                                                     " delta=", row.delta, " cells=", row.columns)),
                                  rates);
    EXPECT_LT(predicted, 2.5 * row.seconds) << row.rho;
    EXPECT_GT(predicted, row.seconds / 2.5) << row.rho;
  }
}

}  // namespace
}  // namespace ballpiston
