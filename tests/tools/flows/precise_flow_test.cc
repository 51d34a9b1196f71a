#include "tools/flows/precise_flow.h"

#include "core/billiard/reference_flow.h"
#include "core/sampling/invariant_measure.h"
#include "tests/core/preamble.h"
#include "tools/flows/rounded_to.h"

namespace ballpiston {
namespace {

PairState StartInEquilibrium(const PairGeometry& geometry, uint64_t sample) {
  CounterRandom random(17, 0, sample);
  return DrawFromFlowMeasure(geometry, random);
}

// The same billiard in every precision: a few flights from the same state, compared with 256 bits.
// An error grows by about a factor of e per flight, e^8 = 3e3 in total, and by more on grazing
// orbits. Therefore the test uses the geometric mean over orbits, in rounding units of the
// precision.
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
  // Measured: 160 to 300. The scatter of 50 orbits is a factor of e^0.4: a factor of ten is enough.
  for (const double error :
       {MeanErrorOverRounding<float>(), MeanErrorOverRounding<double>(),
        MeanErrorOverRounding<long double>(), MeanErrorOverRounding<Quadruple>()}) {
    EXPECT_GT(error, 15);
    EXPECT_LT(error, 3000);
  }
}

// In its own precision the direction has length 1 and the ball is on the wall, to a few rounding
// errors, as soon as the rounding of the start to doubles has no effect any longer.
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
