#include "core/sampling/outgoing_law.h"

#include "tests/core/preamble.h"
#include "tests/oracle/samples.h"
#include "tests/support/nightly.h"

namespace ballpiston {
namespace {

// The published known-answer vector of Philox4x64-10 for key and counter zero.
TEST(CounterRandom, IsPhilox4x64) {
  CounterRandom random(0, 0, 0);
  EXPECT_EQ(random.Bits(), 0x16554d9eca36314cu);
  EXPECT_EQ(random.Bits(), 0xdb20fe9d672d0fdcu);
  EXPECT_EQ(random.Bits(), 0xd7e772cee186176bu);
  EXPECT_EQ(random.Bits(), 0x7e68b68aec7ba23bu);
}

// The ball's angle to the axis over pi if sigma is -1, and 1 more if it is 1.
double PlaceOf(const SignedDirection& drawn) {
  return std::acos(drawn.ball.x()) / M_PI + (drawn.sigma < 0 ? 0 : 1);
}

// The distribution function of the place under the law proportional to
// (sigma sqrt(ep) - sqrt(eb) cos a)_+^n, by the midpoint rule: good to 1e-5.
class LawByMidpoints {
 public:
  LawByMidpoints(double epsilon, double exponent) {
    const double ball = std::sqrt(0.5 - epsilon), piston = std::sqrt(epsilon);
    for (size_t i = 0; i < 2 * kCells; ++i) {
      const double cosine = std::cos(M_PI * (static_cast<double>(i % kCells) + 0.5) / kCells);
      const double base = (i < kCells ? -piston : piston) - ball * cosine;
      sums_.push_back(sums_.back() + (base > 0 ? std::pow(base / (ball + piston), exponent) : 0));
    }
  }

  double operator()(double place) const {
    const double x = place * kCells;
    const size_t cell = std::min(static_cast<size_t>(x), 2 * kCells - 1);
    return std::lerp(sums_[cell], sums_[cell + 1], x - static_cast<double>(cell)) / sums_.back();
  }

 private:
  static constexpr size_t kCells = 40'000;  // of half a circle
  std::vector<double> sums_ = {0};
};

class OutgoingLawOf : public testing::TestWithParam<std::tuple<double, double>> {};

// False alarms: 2.7e-6 for each law, and 6e-7 for its symmetry.
TEST_P(OutgoingLawOf, AgreesWithQuadrature) {
  const auto [epsilon, exponent] = GetParam();
  CounterRandom random(3, 0, 0);
  const OutgoingLaw law(epsilon, exponent);
  std::vector<double> places(IsNightly() ? 200'000 : 40'000);
  Moments sine;
  for (double& place : places) {
    const SignedDirection drawn = law.Draw(random);
    ASSERT_GT(drawn.sigma * std::sqrt(epsilon) - std::sqrt(0.5 - epsilon) * drawn.ball.x(), 0);
    place = PlaceOf(drawn);
    sine.Add(drawn.ball.y());
  }
  EXPECT_LT(oracle::KolmogorovSmirnov(places, LawByMidpoints(epsilon, exponent)), 2.6);
  EXPECT_NEAR(sine.mean, 0, 5 * *sine.StandardError());
}

// A proposal takes two numbers, and a draw one more. They are counted by drawing them again.
TEST_P(OutgoingLawOf, ThreeInFourProposalsAreAccepted) {
  constexpr int kDraws = 10'000;
  const auto [epsilon, exponent] = GetParam();
  const OutgoingLaw law(epsilon, exponent);
  CounterRandom random(3, 0, 0), again(3, 0, 0);
  for (int i = 0; i < kDraws; ++i) law.Draw(random);
  int numbers = 0;
  for (const uint64_t next = random.Bits(); again.Bits() != next;) ++numbers;
  EXPECT_LE((numbers - kDraws) / 2, kDraws * 4 / 3);
}

INSTANTIATE_TEST_SUITE_P(EnergiesAndExponents, OutgoingLawOf,
                         testing::Combine(testing::Values(0.0, 1e-9, 0.03125, 0.125, 0.25, 0.375,
                                                          0.46875, 0.5),
                                          testing::Values(0.0, 0.5, 1.0, 5.0, 10.0, 1000.0)));

}  // namespace
}  // namespace ballpiston
