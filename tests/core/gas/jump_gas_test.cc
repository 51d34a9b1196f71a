#include "core/gas/jump_gas.h"

#include "core/closed_form/kernel_distribution.h"
#include "core/closed_form/kernel_moments.h"
#include "core/gas/gas_meter.h"
#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"
#include "tests/oracle/one_sample.h"

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

// In the kernel's units a contact has the relative velocity v.n, n = (1, 0, -1)/sqrt(2).
double ContactRate(double eb, double ep) {
  return kDensity * std::numbers::sqrt2 * CollisionRate(eb, ep);
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
  gas.Begin(start);
  for (double begin = 0;;) {
    JumpGas next = gas;
    GasMeter meter(geometry, start);
    next.AdvanceTo(begin + step, meter);
    if (meter.exchanges() == 1) return AfterOne(meter, start, begin + step);
    if (meter.exchanges() == 0) {
      gas = next;
      begin += step;
    } else {
      step /= 2;
    }
  }
}

double Exponential(double x) { return -std::expm1(-x); }

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
    std::vector<uint64_t> counts(4);
    for (uint64_t replica = 0; replica < kReplicas; ++replica) {
      const CounterRandom random(81, row, replica);
      const FirstExchange first =
          Find(JumpGas(ring, kDensity, ThermalWalls(), random), ring, start, 0.3 / sum);
      times.push_back(first.time * sum);
      ++counts[2 * first.ball + first.piston];
      const double eb = e.balls[first.ball], ep = e.pistons[first.piston];
      places.push_back(KernelDistribution(eb, ep).Below(first.piston_energy));
      ASSERT_NEAR(first.ball_energy + first.piston_energy, eb + ep, 1e-15 * (eb + ep));
    }
    EXPECT_LT(oracle::KolmogorovSmirnov(times, Exponential), 2.3);
    EXPECT_LT(oracle::KolmogorovSmirnov(places, [](double x) { return x; }), 2.3);
    EXPECT_LT(oracle::ChiSquareScoreOf(counts, rates), 4);
    ++row;
  }
}

// The same in a lattice of one cell: two pistons, each met from both sides. False alarms: 1e-4.
TEST(JumpGas, APistonThatABallSeesTwiceHasTwoContacts) {
  const GasGeometry torus = GasOf(kPaperRho, 0.2, "1x1");
  const GasState start = WithEnergies({1}, {0.5, 0.1});
  const double sum = 2 * (ContactRate(1, 0.5) + ContactRate(1, 0.1));
  std::vector<double> times;
  for (uint64_t replica = 0; replica < kReplicas; ++replica) {
    const CounterRandom random(82, 0, replica);
    times.push_back(
        sum * Find(JumpGas(torus, kDensity, ThermalWalls(), random), torus, start, 0.3 / sum).time);
  }
  EXPECT_LT(oracle::KolmogorovSmirnov(times, Exponential), 2.3);
}

// An outermost piston has a thermal velocity at every instant: the rate is the thermal mean. One
// cell between a hot and a cold reservoir. False alarms: 1e-4.
TEST(JumpGas, OutermostPistonsAreThermal) {
  constexpr double kHot = 3, kCold = 0.5, kBall = 1;
  const GasGeometry chain = GasOf(kPaperRho, 0.2, "1", GasEnds::kReservoirs);
  // The initial energies of these pistons have no effect.
  const GasState start = WithEnergies({kBall}, {17, 1e-3});
  const auto thermal_rate = [&](double temperature) {
    const auto integrand = [&](Quad v3) {
      const auto v = static_cast<double>(v3);
      return std::exp(-v * v / (2 * temperature)) * ContactRate(kBall, v * v / 2);
    };
    const double width = std::sqrt(temperature), speed = std::sqrt(2 * kBall);
    const Quad all = oracle::IntegrateToRoot(integrand, 0, speed) +
                     oracle::Integrate(integrand, speed, speed + 5 * width) +
                     oracle::Integrate(integrand, speed + 5 * width, speed + 12 * width);
    return static_cast<double>(all) * 2 / (width * std::sqrt(2 * std::numbers::pi));
  };
  const double hot = thermal_rate(kHot), cold = thermal_rate(kCold);
  std::vector<double> times;
  std::vector<uint64_t> counts(2);
  for (uint64_t replica = 0; replica < kReplicas; ++replica) {
    const GasRandom random(83, 0, replica);
    const FirstExchange first =
        Find(JumpGas(chain, kDensity, ThermalWalls(chain, kHot, kCold, random), random.OfJumps()),
             chain, start, 0.3 / (hot + cold));
    times.push_back(first.time * (hot + cold));
    ++counts[first.piston];
    EXPECT_EQ(first.piston_energy, (first.piston == 0 ? kHot : kCold) / 2);
  }
  EXPECT_LT(oracle::KolmogorovSmirnov(times, Exponential), 2.3);
  EXPECT_LT(oracle::ChiSquareScoreOf(counts,
                                     std::vector<double>{hot / (hot + cold), cold / (hot + cold)}),
            4);
}

// A ring is isolated. An exchange rounds each energy.
TEST(JumpGas, EnergyIsConserved) {
  const GasGeometry gas = GasOf(kPaperRho, 0.2, "4x4");
  const GasState start = GasInEquilibrium(gas, 1, 84, 0);
  GasMeter meter(gas, start);
  JumpGas jumps(gas, kDensity, ThermalWalls(), CounterRandom(84, 0, 0));
  jumps.Begin(start);
  jumps.AdvanceTo(5000, meter);
  EXPECT_GT(meter.exchanges(), 10'000u);
  double sum = 0;
  for (size_t body = 0; body < meter.bodies(); ++body) sum += meter.Energy(body);
  EXPECT_NEAR(sum / EnergyOf(start), 1, 1e-13);
}

// Twice the density is the same gas, twice as fast.
TEST(JumpGas, DensityIsAScaleOfTime) {
  const GasGeometry gas = GasOf(kPaperRho, 0.2, "5");
  const GasState start = GasInEquilibrium(gas, 1, 85, 0);
  GasMeter slow(gas, start), fast(gas, start);
  for (const double density : {1, 2}) {
    JumpGas jumps(gas, density, ThermalWalls(), CounterRandom(85, 0, 0));
    jumps.Begin(start);
    jumps.AdvanceTo(200 / density, density == 1 ? slow : fast);
  }
  EXPECT_GT(slow.exchanges(), 100u);
  EXPECT_EQ(slow.exchanges(), fast.exchanges());
  for (size_t body = 0; body < slow.bodies(); ++body) {
    EXPECT_EQ(slow.Energy(body), fast.Energy(body));
  }
}

}  // namespace
}  // namespace ballpiston
