#include "tools/method_comparison/trajectory_horizon.h"

#include "tests/core/preamble.h"

namespace ballpiston::method_comparison {
namespace {

constexpr RandomStream kStreamOfTwins = {31, 7};
constexpr size_t kTwins = 64;

// The ball's Lyapunov exponent per hit, from the growth of a displacement of 1e-60, which stays
// small.
Moments LyapunovExponents() {
  constexpr int kHits = 60;
  const TwinOrbits twins(kPaperPair, {32, 7}, kTwins);
  Moments exponents;
  for (size_t i = 0; i < kTwins; ++i) {
    TwinOrbits::State displaced = twins.Start(i);
    const TwinNumber angle("1e-60");
    const TwinNumber x = displaced.direction.x(), y = displaced.direction.y();
    displaced.direction = {TwinNumber(x - angle * y), TwinNumber(y + angle * x)};
    EventFlow<TwinNumber> one(kPaperPair, twins.Start(i)), other(kPaperPair, displaced);
    for (int hit = 0; hit < kHits; ++hit) {
      one.Step();
      other.Step();
    }
    const PairStateOf<TwinNumber>::Vector apart = other.state().direction - one.state().direction;
    const double ratio = static_cast<double>(TwinNumber(apart.norm() / angle));
    exponents.Add(std::log(ratio) / kHits);
  }
  return exponents;
}

TrajectoryHorizon HorizonOfMethod(const Method& method) {
  TwinOrbits twins(kPaperPair, kStreamOfTwins, kTwins);
  return HorizonOf(method, kPaperPair, twins);
}

double CombinedError(const Moments& a, const Moments& b) {
  return std::hypot(*a.StandardError(), *b.StandardError());
}

// Each precision against the next: H' - H = (bits' - bits) log 2/L, with a separate measurement of
// L. Three comparisons at 4.5 combined standard errors, with a fixed seed; one in 5e4 seeds would
// fail.
TEST(TrajectoryHorizon, HorizonGrowsWithTheLogarithmOfThePrecision) {
  const Moments exponents = LyapunovExponents();
  const double error_of_exponent = *exponents.StandardError() / exponents.mean;
  Moments before = HorizonOfMethod(kReferenceSingle).hits;
  int bits_before = 24;
  for (const auto& [method, bits] :
       {std::pair{kReference, 53}, {kReferenceLongDouble, 64}, {kReferenceQuadruple, 113}}) {
    const Moments now = HorizonOfMethod(method).hits;
    const double expected = (bits - bits_before) * std::numbers::ln2 / exponents.mean;
    EXPECT_NEAR(now.mean - before.mean, expected,
                4.5 * std::hypot(CombinedError(now, before), expected * error_of_exponent))
        << bits << " bits";
    before = now;
    bits_before = bits;
  }
}

// A relative error of 1e-16 gives about 32 hits.
TEST(TrajectoryHorizon, LanesPartAfterAsManyHitsAsTheReference) {
  const Moments reference = HorizonOfMethod(kReference).hits, lanes = HorizonOfMethod(kLanes).hits;
  EXPECT_NEAR(reference.mean, 32, 2);
  EXPECT_NEAR(lanes.mean, reference.mean, 1 + 4.5 * CombinedError(lanes, reference));
  const Moments single = HorizonOfMethod(kReferenceSingle).hits,
                lanes_single = HorizonOfMethod(kLanesSingle).hits;
  EXPECT_NEAR(lanes_single.mean, single.mean, 1 + 4.5 * CombinedError(lanes_single, single));
}

}  // namespace
}  // namespace ballpiston::method_comparison
