#include "tools/slow_pistons/correlation_windows.h"

#include "tests/core/preamble.h"

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

}  // namespace
}  // namespace ballpiston::slow_pistons
