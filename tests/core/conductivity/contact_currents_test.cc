#include "core/conductivity/contact_currents.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

using SixValues = std::array<double, 6>;

SixValues Listed(const ContactCurrents& c) {
  return {c.energy, c.products, c.ball[0], c.ball[1], c.piston[0], c.piston[1]};
}

// The sum over angles and signs, by the midpoint rule.
SixValues ByDefinition(const TestFunction& f, double ball, double piston) {
  constexpr int kAngles = 40'000;
  const TestFunction::Values u = f.OfBall(ball), w = f.OfPiston(piston);
  SixValues sum = {};
  for (const double v3 : {std::sqrt(2 * piston), -std::sqrt(2 * piston)}) {
    for (int k = 0; k < kAngles; ++k) {
      const double v1 = std::sqrt(2 * ball) * std::cos(std::numbers::pi * (k + 0.5) / kAngles);
      const double rate = std::max(v1 - v3, 0.0) / (2 * kAngles);
      const double after = v1 * v1 / 2;
      const TestFunction::Values u1 = f.OfBall(ball + piston - after), w1 = f.OfPiston(after);
      sum[0] += rate * (after - piston);
      for (size_t r = 0; r < 2; ++r) {
        sum[1] += rate * (u1[r] - u[r]) * (w1[r] - w[r]);
        sum[2 + r] += rate * (u1[r] - u[r]);
        sum[4 + r] += rate * (w1[r] - w[r]);
      }
    }
  }
  return sum;
}

// The rule's error is of the order of its step to the power 5/2, where the rate has its corner.
TEST(ContactCurrents, AgreeWithTheirDefinition) {
  for (const TestFunction& f : {kChainTestFunction, kLatticeTestFunction}) {
    for (const auto& [ball, piston] : std::vector<std::pair<double, double>>{
             {1, 0.5}, {0.5, 1}, {2, 1.99}, {1, 1}, {0, 0.7}, {0.7, 0}, {6, 0.01}, {0.01, 4}}) {
      const SixValues expected = ByDefinition(f, ball, piston);
      const SixValues found = Listed(ContactCurrentsOf(f, ball, piston));
      for (size_t i = 0; i < found.size(); ++i) {
        EXPECT_NEAR(found[i], expected[i], 1e-8) << ball << " " << piston << " value " << i;
      }
    }
  }
}

TEST(ContactCurrents, TableErrorIsWithinItsBound) {
  std::mt19937_64 random(1);
  std::gamma_distribution<double> of_a_ball(1), of_a_piston(0.5);
  for (const ContactCurrentsTable* table :
       {&ContactCurrentsTable::OfChain(), &ContactCurrentsTable::OfLattice()}) {
    SixValues squares = {}, errors = {};
    for (int i = 0; i < 20'000; ++i) {
      const double ball = of_a_ball(random), piston = of_a_piston(random);
      const SixValues exact = Listed(ContactCurrentsOf(table->test_function(), ball, piston));
      const SixValues found = Listed(table->At(ball, piston));
      for (size_t k = 0; k < exact.size(); ++k) {
        squares[k] += exact[k] * exact[k];
        errors[k] += (found[k] - exact[k]) * (found[k] - exact[k]);
      }
    }
    for (size_t k = 0; k < squares.size(); ++k) {
      EXPECT_LT(std::sqrt(errors[k] / squares[k]), kContactCurrentsError) << "value " << k;
    }
  }
}

// Energies beyond the table give inexact but finite numbers. Equilibrium never has such energies.
TEST(ContactCurrents, TableTakesEveryEnergy) {
  for (const double energy : {1e-300, 1e-10, 35.9, 36.1, 1e3}) {
    for (const double value : Listed(ContactCurrentsTable::OfChain().At(energy, energy / 3))) {
      EXPECT_TRUE(std::isfinite(value)) << energy;
    }
  }
}

}  // namespace
}  // namespace ballpiston
