#include "core/sampling/outgoing_law.h"

#include "tests/core/preamble.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

struct Means {
  double cosine = 0;
  double sigma = 0;
};

// Of the law proportional to (sigma sqrt(ep) - sqrt(eb) cos a)_+^n, by the midpoint rule:
// spectrally accurate for whole n >= 2, and good to 1e-5 with the kink (n = 1) or jump (n = 0).
Means MeansByMidpoints(double epsilon, double exponent) {
  constexpr int kCells = 40'000;
  const double ball = std::sqrt(0.5 - epsilon), piston = std::sqrt(epsilon);
  double total = 0;
  Means sums;
  for (const int sigma : {-1, 1}) {
    for (int i = 0; i < kCells; ++i) {
      const double cosine = std::cos(2 * M_PI * (i + 0.5) / kCells);
      const double base = sigma * piston - ball * cosine;
      if (base <= 0) continue;
      const double weight = std::pow(base / (ball + piston), exponent);
      total += weight;
      sums.cosine += weight * cosine;
      sums.sigma += weight * sigma;
    }
  }
  return {sums.cosine / total, sums.sigma / total};
}

class OutgoingLawMoments : public testing::TestWithParam<std::tuple<double, double>> {};

// 5 standard errors at 30,000 samples (nightly 100,000): false alarms 1e-6 a comparison. The 1e-5
// is the quadrature's.
TEST_P(OutgoingLawMoments, AgreeWithQuadrature) {
  const auto [epsilon, exponent] = GetParam();
  const Means exact = MeansByMidpoints(epsilon, exponent);
  CounterRandom random(3, 0, 0);
  const OutgoingLaw law(epsilon, exponent);
  Moments cosine, sine, sigma;
  const int samples = IsNightly() ? 100'000 : 30'000;
  for (int i = 0; i < samples; ++i) {
    const SignedDirection drawn = law.Draw(random);
    ASSERT_GT(drawn.sigma * std::sqrt(epsilon) - std::sqrt(0.5 - epsilon) * drawn.ball.x(), 0);
    cosine.Add(drawn.ball.x());
    sine.Add(drawn.ball.y());
    sigma.Add(drawn.sigma);
  }
  EXPECT_NEAR(cosine.mean, exact.cosine, 5 * *cosine.StandardError() + 1e-5);
  EXPECT_NEAR(sine.mean, 0, 5 * *sine.StandardError());
  EXPECT_NEAR(sigma.mean, exact.sigma, 5 * *sigma.StandardError() + 1e-5);
}

INSTANTIATE_TEST_SUITE_P(EnergiesAndExponents, OutgoingLawMoments,
                         testing::Combine(testing::Values(0.0, 1e-9, 0.03125, 0.125, 0.25, 0.375,
                                                          0.46875, 0.5),
                                          testing::Values(0.0, 0.5, 1.0, 5.0, 10.0, 1000.0)));

}  // namespace
}  // namespace ballpiston
