#include "core/arithmetic/elementary_functions.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// The worst of some errors |value - exact|, in units in the last place of the exact value. A long
// double has at least eleven bits more, so the C library's rounding of `exact` is a thousandth of a
// unit. Above half a unit the comparison sees rounding.
class WorstError {
 public:
  void Add(double value, long double exact) {
    static_assert(std::numeric_limits<long double>::digits >= 64);
    const int exponent = exact == 0 ? -1021 : std::ilogb(exact);
    const long double error = std::ldexp(std::fabs(value - exact), 52 - exponent);
    worst_ = std::max(worst_, static_cast<double>(error));
  }
  void ExpectWithin(double bound) const {
    EXPECT_LE(worst_, bound);
    EXPECT_GT(worst_, 0.5);
  }

 private:
  double worst_ = 0;
};

constexpr int kSamples = 500'000;

TEST(ElementaryFunctions, AnglesAreWithinTheirBound) {
  CounterRandom random(1, 0, 0);
  WorstError worst;
  const auto compare = [&worst](double y, double x) {
    worst.Add(Atan2(y, x), std::atan2<long double>(y, x));
  };
  for (int i = 0; i < kSamples; ++i) {
    const double x = 2 * random.Uniform() - 1, y = 2 * random.Uniform() - 1;
    const double tiny = std::exp2(-200 * random.Uniform());
    for (const double factor : {1.0, tiny}) {  // every octant, and next to every axis
      compare(factor * y, x);
      compare(y, factor * x);
      compare(x + factor * y, x);  // and diagonal
    }
    const double eighth = (std::floor(9 * random.Uniform()) + 0.5) / 8;
    compare(eighth * (1 + 0x1p-40 * y), 1);  // where the table's entry changes
  }
  worst.ExpectWithin(kAtan2UlpError);
}

TEST(ElementaryFunctions, PowersAreWithinTheirBound) {
  CounterRandom random(2, 0, 0);
  WorstError worst;
  const auto compare = [&worst](double base, double exponent) {
    const long double exact = std::pow(static_cast<long double>(base), exponent);
    if (exact < 1e-300L) return;
    worst.Add(Power(base, exponent), exact);
  };
  for (int i = 0; i < kSamples / 2; ++i) {
    const double base = random.Uniform(), exponent = random.Uniform();
    for (const double scale : {1e-9, 0.5, 10.0, 1000.0}) compare(base, scale * exponent);
    compare(std::exp2(-900 * base), exponent);
    compare(1 - std::exp2(-53 * base), 1000 * exponent);  // next to 1
    compare((6.5 + std::floor(10 * base)) / 16, 100 * exponent);
    compare(std::exp(-690 * base / (1000 * exponent)), 1000 * exponent);
  }
  worst.ExpectWithin(kPowerUlpError);
}

TEST(ElementaryFunctions, ExponentialsAreWithinTheirBound) {
  CounterRandom random(3, 0, 0);
  WorstError worst;
  const auto compare = [&worst](double x) {
    worst.Add(Exp(x), std::exp(static_cast<long double>(x)));
  };
  for (int i = 0; i < kSamples; ++i) {
    const double x = random.Uniform(), sign = random.Uniform() < 0.5 ? -1 : 1;
    for (const double scale : {1e-300, 1e-16, 1e-3, 1.0, 30.0, 700.0}) compare(sign * scale * x);
    compare(sign * std::exp2(-60 * x));
    // Arguments at which the power of two in 2^k exp(r) changes.
    compare((std::floor(1000 * x) - 500.5) * std::numbers::ln2 * (1 + 0x1p-50 * sign));
  }
  worst.ExpectWithin(kExpUlpError);
}

TEST(ElementaryFunctions, LogarithmsAreWithinTheirBound) {
  CounterRandom random(4, 0, 0);
  WorstError worst;
  const auto compare = [&worst](double x) {
    worst.Add(Log(x), std::log(static_cast<long double>(x)));
  };
  for (int i = 0; i < kSamples; ++i) {
    const double x = random.Uniform(), sign = random.Uniform() < 0.5 ? -1 : 1;
    compare(x);
    compare(1 + x);
    compare(std::exp2(960 * sign * x));
    compare(1 + sign * std::exp2(-53 * x));                           // next to 1
    compare((6.5 + std::floor(10 * x)) / 16 * (1 + 0x1p-50 * sign));  // the table's entry changes
  }
  worst.ExpectWithin(kLogUlpError);
}

TEST(ElementaryFunctions, AnglesOnAxesAndDiagonals) {
  constexpr double kPi = std::numbers::pi;
  for (const double r : {1e-150, 1.0, 0.3, 1e150}) {
    for (const double sign : {1.0, -1.0}) {
      EXPECT_EQ(Atan2(sign * 0.0, r), 0);
      EXPECT_EQ(std::signbit(Atan2(sign * 0.0, r)), sign < 0);
      EXPECT_EQ(Atan2(sign * r, r), sign * kPi / 4);
      EXPECT_EQ(Atan2(sign * r, 0.0), sign * kPi / 2);
      EXPECT_EQ(Atan2(sign * r, -0.0), sign * kPi / 2);
      EXPECT_EQ(Atan2(sign * r, -r), sign * 3 * kPi / 4);
      EXPECT_EQ(Atan2(sign * 0.0, -r), sign * kPi);
    }
  }
  EXPECT_EQ(Atan2(0.0, 0.0), 0);
}

TEST(ElementaryFunctions, SimpleValuesAreExact) {
  for (const double n : {0.0, 1e-300, 0.5, 1.0, 1000.0}) EXPECT_EQ(Power(1, n), 1);
  for (const double base : {1e-290, 0.1, 0.75, 1 - 0x1p-53}) {
    EXPECT_EQ(Power(base, 0), 1);
    EXPECT_EQ(Power(base, 1), base);
  }
  EXPECT_EQ(Power(0.25, 0.5), 0.5);
  EXPECT_EQ(Power(1e-16, 1000), 0);
  for (const double x : {0.0, -0.0, -1e-300}) EXPECT_EQ(Exp(x), 1);
  for (const double x : {-700.1, -HUGE_VAL}) EXPECT_EQ(Exp(x), 0);
  EXPECT_EQ(Log(1), 0);
  EXPECT_FALSE(std::signbit(Log(1)));
}

}  // namespace
}  // namespace ballpiston
