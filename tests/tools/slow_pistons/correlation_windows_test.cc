#include "tools/slow_pistons/correlation_windows.h"

#include "tests/core/preamble.h"
#include "tools/slow_pistons/idle_pistons.h"

namespace ballpiston::slow_pistons {
namespace {

TEST(CorrelationWindows, LimitOfAllIsTheIntegralTime) {
  EXPECT_NEAR(LimitOfAll(1e3), 0.541387668432, 1e-9);
}

// int_0^1 45 (u^2/2 - 1/6)^2/(4 r(u)) du by the midpoint rule with 10^6 intervals.
TEST(CorrelationWindows, LimitOfIdleIsThatOfTheMidpointRule) {
  EXPECT_NEAR(LimitOfIdle(1e3), 0.9123158138, 1e-8);
}

void ExpectNear(const Moments& measured, double limit, double bias) {
  EXPECT_LT(std::fabs(measured.mean - limit), 4.5 * measured.StandardError().value() + bias);
}

// At delta = 0.05 the billiard differs from its limit by 0.6 % up to 8 mean free times. The false
// alarm rate is 2e-5.
TEST(CorrelationWindows, WindowsAreThoseOfTheJumpProcess) {
  constexpr double kBias = 0.005;
  const PairGeometry geometry = PairGeometry::Create(0.529561127988977, 0.05).value();
  const WindowIntegrals first = CorrelationWindows(geometry, 512, 1).front();
  ExpectNear(first.all, first.limit_all, kBias);
  ExpectNear(first.idle, first.limit_idle, kBias);
  ExpectNear(first.met, first.limit_all - first.limit_idle, kBias);
  EXPECT_LT(first.met.StandardError().value(), 0.02);
}

// ---- idle_pistons.h ----

// Four comparisons: the false alarm rate is 3e-5 with normal errors.
TEST(IdlePistons, OutermostPistonsInEquilibriumHaveTheirLimit) {
  constexpr double kTemperature = 0.25;
  const GasGeometry geometry =
      GasGeometry::Create(0.529561127988977, 0.2, GasShape{.columns = 1}, GasEnds::kReservoirs)
          .value();
  const double crossing = geometry.pair().lambda() + geometry.pair().delta();
  const double limit = crossing * crossing / geometry.pair().stroke() /
                       std::sqrt(2 * std::numbers::pi * kTemperature);
  const auto pistons = IdlePistons(
      geometry, {.hot = kTemperature, .cold = kTemperature, .block = 1e4, .blocks = 64, .seed = 1});
  ASSERT_EQ(pistons.size(), 2u);
  for (const IdleShares& piston : pistons) {
    for (const size_t i : {1, 2}) {  // s is 8 and 16
      // A flight at speed v is longer than s if v < L'/s, and 1 - exp(-v^2/2 T) is v^2/2 T.
      const double bias = std::pow(crossing / kIdleTimes[i], 2) / (4 * kTemperature) * limit;
      const Moments& measured = piston[i].limit;
      EXPECT_LT(std::fabs(measured.mean - limit), 4.5 * measured.StandardError().value() + bias);
      EXPECT_LT(measured.StandardError().value(), 0.03 * limit);
    }
  }
}

}  // namespace
}  // namespace ballpiston::slow_pistons
