#include "tools/flows/precise_flow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/billiard/reference_flow.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/geometries.h"

namespace ballpiston {
namespace {

PairState StartInEquilibrium(const PairGeometry& geometry, uint64_t sample) {
  CounterRandom random(17, 0, sample);
  return DrawFromFlowMeasure(geometry, random);
}

// The same billiard in every precision: a few flights from the same state, against 256 bits.
// An error grows by some e a flight, e^8 = 3e3 in all, by more where an orbit grazes: it is looked
// at in the geometric mean over orbits, in units of the precision's rounding.
template <typename Real>
double MeanErrorOverRounding() {
  constexpr int kOrbits = 50, kFlights = 8;
  double sum = 0;
  for (uint64_t sample = 0; sample < kOrbits; ++sample) {
    PairStateOf<TwinNumber> start = RoundedTo<TwinNumber>(StartInEquilibrium(kPaperPair, sample));
    start.direction /= TwinNumber(start.direction.norm());
    EventFlow<Real> flow(kPaperPair, RoundedTo<Real>(start));
    EventFlow<TwinNumber> twin(kPaperPair, start);
    for (int i = 0; i < kFlights; ++i) {
      if (flow.Step().kind == EventKind::kBallPiston) flow.ExchangeComponents();
      if (twin.Step().kind == EventKind::kBallPiston) twin.ExchangeComponents();
    }
    const auto state = RoundedTo<TwinNumber>(flow.state());
    const PairStateOf<TwinNumber>::Vector apart = state.direction - twin.state().direction;
    const TwinNumber rounding = static_cast<TwinNumber>(std::numeric_limits<Real>::epsilon());
    sum += std::log(static_cast<double>(TwinNumber(apart.norm() / rounding)));
  }
  return std::exp(sum / kOrbits);
}

TEST(PreciseFlow, ErrorsShrinkWithThePrecision) {
  // Found: 160 to 300, with the scatter of 50 orbits, e^0.4, so a factor of ten leaves room.
  for (const double error :
       {MeanErrorOverRounding<float>(), MeanErrorOverRounding<double>(),
        MeanErrorOverRounding<long double>(), MeanErrorOverRounding<Quadruple>()}) {
    EXPECT_GT(error, 15);
    EXPECT_LT(error, 3000);
  }
}

// In its own precision: the direction's length is 1 and the ball on the wall, to some roundings, as
// soon as it has forgotten that it began as doubles.
template <typename Real>
void ExpectHealthy(const PairGeometry& geometry, int events) {
  EventFlow<Real> flow(geometry, RoundedTo<Real>(StartInEquilibrium(geometry, 6)));
  const double rounding = static_cast<double>(std::numeric_limits<Real>::epsilon());
  const Real rho = static_cast<Real>(geometry.rho()), half = static_cast<Real>(0.5);
  for (int i = 0; i < events; ++i) {
    const EventOf<Real> event = flow.Step();
    ASSERT_NE(event.kind, EventKind::kEscape) << "rho " << geometry.rho() << " event " << i;
    ASSERT_GE(event.duration, 0);
    if (event.kind == EventKind::kBallPiston) flow.ExchangeComponents();
    ASSERT_LE(EnergyError(RoundedTo<double>(flow.state())), 10 * rounding + 2e-15);
    if (event.kind != EventKind::kBallWall || i < 20) continue;
    const auto& state = flow.state();
    const Real length = state.direction.squaredNorm() - 1;
    ASSERT_LE(std::fabs(static_cast<double>(length)), 10 * rounding) << "event " << i;
    const Real x = half - (state.position.x() < 0 ? -state.position.x() : state.position.x());
    const Real y = half - (state.position.y() < 0 ? -state.position.y() : state.position.y());
    const Real off = x * x + y * y - rho * rho;
    ASSERT_LE(std::fabs(static_cast<double>(off)), 10 * rounding) << "event " << i;
  }
}

TEST(PreciseFlow, OtherPrecisionsStayHealthy) {
  for (const PairGeometry& geometry : GeometriesOfFlows()) {
    if (geometry.rho() < 0.5001) continue;  // a cusp narrower than single precision resolves
    ExpectHealthy<float>(geometry, 20'000);
    ExpectHealthy<long double>(geometry, 20'000);
    ExpectHealthy<Quadruple>(geometry, 500);
    ExpectHealthy<TwinNumber>(geometry, 100);
  }
}

}  // namespace
}  // namespace ballpiston
