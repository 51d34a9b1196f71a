#include "tools/slow_pistons/idle_pistons.h"

#include "tests/core/preamble.h"

namespace ballpiston::slow_pistons {
namespace {

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
