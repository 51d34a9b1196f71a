#include "core/gas/jump_current.h"

#include "core/gas/gas_exchange_rate.h"
#include "core/gas/gas_meter.h"
#include "core/sampling/direction.h"
#include "tests/core/gas/gases.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

struct Energies {
  std::vector<double> balls;
  std::vector<double> pistons;
};

Energies EnergiesOf(const GasState& state) {
  Energies energies;
  for (const GasBall& ball : state.balls) energies.balls.push_back(EnergyOf(ball));
  for (const GasPiston& piston : state.pistons) energies.pistons.push_back(EnergyOf(piston));
  return energies;
}

// The test function of the whole gas.
double ValueOf(const TestFunction& f, const GasGeometry& gas, const Energies& e) {
  double sum = 0;
  for (int64_t ball = 0; ball < gas.balls(); ++ball) {
    const auto u = f.OfBall(e.balls[static_cast<size_t>(ball)]);
    for (const Direction direction : {Direction::kRight, Direction::kLeft}) {
      const auto piston = static_cast<size_t>(gas.PistonOf(ball, direction));
      const auto w = f.OfPiston(e.pistons[piston]);
      sum += SignOf(direction) * (u * w).sum();
    }
  }
  return sum;
}

// Twice J and J' by their definition: the sum, over all possible next exchanges, of the change of
// the field and of the test function, by the midpoint rule over the ball's angle.
struct Currents {
  double all = 0;
  double left = 0;
};

Currents ByDefinition(const GasGeometry& gas, const TestFunction& f, const Energies& e) {
  constexpr int kAngles = 2000;
  Currents sum;
  const double before = ValueOf(f, gas, e);
  for (int64_t ball = 0; ball < gas.balls(); ++ball) {
    for (int i = 0; i < gas.directions(); ++i) {
      const Direction direction = gas.DirectionAt(i);
      const double sign = IsAlongX(direction) ? SignOf(direction) : 0;
      const auto b = static_cast<size_t>(ball);
      const auto p = static_cast<size_t>(gas.PistonOf(ball, direction));
      for (int k = 0; k < 2 * kAngles; ++k) {
        const double v1 =
            std::sqrt(2 * e.balls[b]) * std::cos(std::numbers::pi * (k / 2 + 0.5) / kAngles);
        const double v3 = (k % 2 == 0 ? 1 : -1) * std::sqrt(2 * e.pistons[p]);
        if (v1 <= v3) continue;
        const double weight = (v1 - v3) / (2 * kAngles);
        Energies after = e;
        const double gained = (v1 * v1 - v3 * v3) / 2;
        after.balls[b] -= gained;
        after.pistons[p] += gained;
        sum.all += weight * sign * gained;
        sum.left += weight * (sign * gained + ValueOf(f, gas, after) - before);
      }
    }
  }
  return sum;
}

class JumpCurrentOf : public testing::TestWithParam<const char*> {};

// Compares after each of some exchanges. Values are about 0.1 for each contact, with a table error
// of 3e-4; the error of the midpoint rule is 1e-6.
TEST_P(JumpCurrentOf, CurrentsMatchTheirDefinition) {
  const GasGeometry gas = GasOf(kPaperRho, 0.1, GetParam());
  const GasState state = GasInEquilibrium(gas, 1, 5, 0);
  JumpCurrent current(gas, GasExchangeRate(gas, 1), state, 1);
  const TestFunction f = gas.shape().is_lattice ? kLatticeTestFunction : kChainTestFunction;
  Energies e = EnergiesOf(state);
  CounterRandom random(6, 0, 0);
  for (int exchanges = 0; exchanges < 6; ++exchanges) {
    const Currents expected = ByDefinition(gas, f, e);
    EXPECT_NEAR(current.current(), expected.all, 2e-4);
    EXPECT_NEAR(current.current_left(), expected.left, 2e-4);
    const auto ball = static_cast<int64_t>(random.Uniform() * static_cast<double>(gas.balls()));
    const Direction direction =
        gas.DirectionAt(static_cast<int>(random.Uniform() * gas.directions()));
    const int64_t piston = gas.PistonOf(ball, direction);
    double &of_ball = e.balls[static_cast<size_t>(ball)],
           &of_piston = e.pistons[static_cast<size_t>(piston)];
    const double total = of_ball + of_piston;
    of_piston = total * random.Uniform();
    of_ball = total - of_piston;
    current.Exchange({.time = 0.1 * exchanges,
                      .ball = ball,
                      .piston = piston,
                      .direction = direction,
                      .ball_energy = of_ball,
                      .piston_energy = of_piston},
                     0);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, JumpCurrentOf,
                         testing::Values("1", "2", "3", "6", "1x2", "2x1", "3x2", "3x3"),
                         [](const auto& tested) { return "Of" + std::string(tested.param); });

}  // namespace
}  // namespace ballpiston
