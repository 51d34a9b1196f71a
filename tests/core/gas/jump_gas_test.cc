#include "core/gas/jump_gas.h"

#include "core/closed_form/kernel.h"
#include "core/gas/gas_meter.h"
#include "core/gas/jump_draws.h"
#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"
#include "tests/oracle/samples.h"

namespace ballpiston {
namespace {

constexpr double kDensity = 0.3;
constexpr uint64_t kReplicas = 20'000;

// Positions have no effect.
GasState WithEnergies(const std::vector<double>& balls, const std::vector<double>& pistons) {
  GasState state;
  for (const double energy : balls) state.balls.push_back({.speed = std::sqrt(2 * energy)});
  for (const double energy : pistons) state.pistons.push_back({.velocity = std::sqrt(2 * energy)});
  return state;
}

// In the kernel's units a contact has the relative velocity v.n, n = (1, 0, -1)/sqrt(2). The kernel
// is that of the total energy 1/2.
double ContactRate(double eb, double ep) {
  const double doubled = 2 * (eb + ep);
  return kDensity * std::sqrt(2 * doubled) * PairCollisionRate(ep / doubled);
}

struct FirstExchange {
  double time = 0;
  size_t ball = 0;
  size_t piston = 0;
  double ball_energy = 0;  // after it
  double piston_energy = 0;
};

// Only one ball has another energy than at the start, and it has had it since the exchange.
FirstExchange AfterOne(GasMeter& meter, const GasState& start, double end) {
  meter.End(end);
  FirstExchange first;
  while (meter.Energy(first.ball) == EnergyOf(start.balls[first.ball])) ++first.ball;
  const size_t n = meter.balls();
  while (meter.Energy(n + first.piston) == EnergyOf(start.pistons[first.piston])) ++first.piston;
  first.ball_energy = meter.Energy(first.ball);
  first.piston_energy = meter.Energy(n + first.piston);
  const double before = EnergyOf(start.balls[first.ball]), after = first.ball_energy;
  first.time = end * (meter.MeanEnergy(first.ball) - after) / (before - after);
  return first;
}

// Steps that end before the first exchange are final; one that ends after the second is halved.
FirstExchange Find(JumpGas gas, const GasGeometry& geometry, const GasState& start, double step) {
  for (double begin = 0;;) {
    JumpGas next = gas;
    GasMeter meter(geometry, start);
    while (!next.AdvanceToward(begin + step, meter)) continue;
    if (meter.exchanges() == 1) return AfterOne(meter, start, begin + step);
    if (meter.exchanges() == 0) {
      gas = next;
      begin += step;
    } else {
      step /= 2;
    }
  }
}

// A ring of two cells, in which each ball meets both pistons: four contacts with their own rates.
// The rate of the first exchange is the sum of these rates; the probability of each contact is in
// proportion to its rate; the energy has the kernel's law. False alarms: 1e-4 a row of energies.
TEST(JumpGas, PairsFollowTheJumpProcess) {
  const GasGeometry ring = GasOf(kPaperRho, 0.2, "2");
  struct Energies {
    double balls[2];
    double pistons[2];
  };
  uint64_t row = 0;
  for (const Energies& e : {Energies{{1, 0.3}, {0.2, 2}}, Energies{{0.5, 5}, {0.01, 0.7}},
                            Energies{{1e-3, 2e-3}, {1, 0.25}}, Energies{{400, 100}, {100, 7}}}) {
    SCOPED_TRACE(testing::Message() << "balls at " << e.balls[0] << " and " << e.balls[1]);
    const GasState start = WithEnergies({e.balls[0], e.balls[1]}, {e.pistons[0], e.pistons[1]});
    std::vector<double> rates;
    double sum = 0;
    for (const double ball : e.balls) {
      for (const double piston : e.pistons) {
        // Each ball sees the piston on its right and the one on its left.
        rates.push_back(ContactRate(ball, piston));
        sum += rates.back();
      }
    }
    for (double& rate : rates) rate /= sum;
    std::vector<double> times, places;
    std::array<uint64_t, 4> counts = {};
    for (uint64_t replica = 0; replica < kReplicas; ++replica) {
      const CounterRandom random(81, row, replica);
      const FirstExchange first =
          Find(JumpGas(ring, kDensity, start, ThermalWalls(), random), ring, start, 0.3 / sum);
      times.push_back(first.time * sum);
      ++counts[2 * first.ball + first.piston];
      const double eb = e.balls[first.ball], ep = e.pistons[first.piston];
      const double doubled = 2 * (eb + ep);
      places.push_back(KernelDistribution(ep / doubled).Below(first.piston_energy / doubled));
      ASSERT_NEAR(first.ball_energy + first.piston_energy, eb + ep, 1e-15 * (eb + ep));
    }
    EXPECT_LT(oracle::KolmogorovSmirnov(times, [](double x) { return -std::expm1(-x); }), 2.3);
    EXPECT_LT(oracle::KolmogorovSmirnov(places, std::identity()), 2.3);
    for (size_t i = 0; i < rates.size(); ++i) {
      const double share = static_cast<double>(counts[i]) / kReplicas;
      EXPECT_NEAR(share, rates[i], 4.5 * std::sqrt(rates[i] * (1 - rates[i]) / kReplicas));
    }
    ++row;
  }
}

// ---- jump_draws.h ----

// Three bodies with a quarter of all places, and two with the others.
TEST(JumpDraws, BodiesAtTheEdgesOfPlacesAreOfTheirKind) {
  const JumpKinds kinds = {
      {{.before = 0, .per_place = 12, .first = 0, .count = 3, .largest = 2},
       {.before = 0.25, .per_place = 2 / 0.75, .first = 3, .count = 2, .largest = 5}}};
  JumpAttempts attempts = {};
  for (size_t i = 0; i < kJumpDraws; ++i) attempts.words[i] = i % 2 == 0 ? 0 : ~uint64_t{0};
  FindJumpAttempts(kinds, attempts);
  for (size_t i = 0; i < kJumpDraws; ++i) {
    EXPECT_EQ(attempts.bodies[i], i % 2 == 0 ? 0 : 4);
    EXPECT_GE(attempts.least_speeds[i], 0);
  }
}

// A kind at rest has no places.
TEST(JumpDraws, OnlyMovingKindsAreChosen) {
  const JumpKinds kinds = {{{.before = 0, .per_place = 3, .first = 0, .count = 3, .largest = 2},
                            {.before = 1, .per_place = INFINITY, .first = 3, .count = 2}}};
  CounterRandom random(1, 2, 4);
  for (int i = 0; i < 1000; ++i) {
    JumpAttempts attempts;
    DrawJumpAttempts(kinds, random, attempts);
    for (const int32_t body : attempts.bodies) ASSERT_LT(body, 3);
  }
}

}  // namespace
}  // namespace ballpiston
