#include "core/markov/relaxation_spectrum.h"

#include "core/closed_form/kernel.h"
#include "core/markov/generator.h"
#include "core/statistics/stated_error.h"
#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"

namespace ballpiston {
namespace {

constexpr double kForEver = std::numeric_limits<double>::infinity();

const RelaxationSpectrum& Spectrum() { return RelaxationSpectrum::Get(); }

// int_0^end of a smooth function, by pieces of length 2.
template <typename F>
double IntegralOver(double end, F f) {
  Quad sum = 0;
  for (double t = 0; t < end; t += 2) {
    sum += oracle::Integrate([&](Quad x) { return f(static_cast<double>(x)); }, t,
                             std::fmin(t + 2, end));
  }
  return static_cast<double>(sum);
}

// Against a finer discretisation, at epsilons inside and at the ends of the elements. A bound is at
// least the least error of a mean.
TEST(RelaxationSpectrum, StatedErrorsAreUpperBounds) {
  const RelaxationSpectrum finer({.degree = 18, .levels = 5});
  const auto expect_bound = [](const BoundedValue& value, const BoundedValue& truth) {
    EXPECT_LE(std::fabs(value.value - truth.value), value.error);
    EXPECT_GE(value.error, (1 - 1e-12) * kRoundingOfAMean * std::fabs(value.value));
  };
  const std::vector<BoundedValue> rates = Spectrum().IsolatedRates();
  for (size_t k = 0; k < rates.size(); ++k) expect_bound(rates[k], finer.IsolatedRates()[k]);
  std::vector<double> epsilons = {1e-12, 0.0005, 0.09875, 0.19, 0.2205, 0.255, 0.4266, 0.49999};
  for (int i = 0; i <= 200; ++i) epsilons.push_back(0.0025 * i);
  for (const double t : {0.0, 0.3, 3.0, 6.0, 16.0, 32.0, kForEver}) {
    expect_bound(Spectrum().CorrelationTime(t), finer.CorrelationTime(t));
    for (const double epsilon : epsilons) {
      SCOPED_TRACE(epsilon);
      expect_bound(Spectrum().DecayIntegral(epsilon, t), finer.DecayIntegral(epsilon, t));
      if (t == kForEver) continue;
      const BoundedValue exact = t == 0 ? BoundedValue{epsilon, 0} : finer.MeanEnergy(epsilon, t);
      expect_bound(Spectrum().MeanEnergy(epsilon, t), exact);
    }
  }
  for (double t = 0; t < 40; t += 0.1) {
    expect_bound(Spectrum().Autocorrelation(t), finer.Autocorrelation(t));
  }
}

TEST(RelaxationSpectrum, IsolatedRatesAscendBelowTheContinuum) {
  const std::vector<BoundedValue> rates = Spectrum().IsolatedRates();
  ASSERT_EQ(rates.size(), 5u);
  EXPECT_EQ(rates[0].value, Spectrum().Gap().value);
  // These numbers were computed with 64-bit mantissas at degree 20 on 8 levels, and rounded.
  constexpr double kKnown[] = {0.1520871266135, 0.1771867982882, 0.1892311255467, 0.1964460932037,
                               0.2012934204112};
  for (size_t k = 0; k < rates.size(); ++k) {
    EXPECT_GT(rates[k].value, k > 0 ? rates[k - 1].value : 0);
    EXPECT_LT(rates[k].value, kContinuumBottom);
    EXPECT_NEAR(rates[k].value, kKnown[k], 1e-13);
  }
}

TEST(RelaxationSpectrum, IntegralsMatchTheCurves) {
  for (const double window : {0.3, 4.0, 32.0}) {
    EXPECT_NEAR(Spectrum().CorrelationTime(window).value,
                IntegralOver(window, [](double t) { return Spectrum().Autocorrelation(t).value; }),
                1e-12 * window);
    for (const double epsilon : {0.0, 0.01, 0.4, 0.5}) {
      const auto excess = [epsilon](double t) {
        return Spectrum().MeanEnergy(epsilon, t).value - kMeanPistonEnergy;
      };
      EXPECT_NEAR(Spectrum().DecayIntegral(epsilon, window).value, IntegralOver(window, excess),
                  1e-12 * window);
    }
  }
  EXPECT_EQ(Spectrum().CorrelationTime(0).value, 0);
  EXPECT_NEAR(Spectrum().CorrelationTime(kForEver).value, 2.165550673728, 1e-11);
  EXPECT_NEAR(Spectrum().CorrelationTime(1000).value, Spectrum().CorrelationTime(kForEver).value,
              1e-14);
  EXPECT_NEAR(Spectrum().DecayIntegral(0.05, 1000).value,
              Spectrum().DecayIntegral(0.05, kForEver).value, 1e-14);
}

TEST(RelaxationSpectrum, MeanEnergyRelaxesFromTheInitialEnergy) {
  // At epsilon = 1/2; elsewhere 1e-13. Found: 3e-12 on x86, 1.3e-11 on AArch64.
  constexpr double kRounding = 5e-11;
  for (const double epsilon : {0.0, 1e-300, 1e-6, 0.01, 0.1, 0.25, 0.4, 0.4999, 0.5}) {
    EXPECT_NEAR(Spectrum().MeanEnergy(epsilon, 0).value, epsilon, kRounding) << epsilon;
    EXPECT_NEAR(Spectrum().MeanEnergy(epsilon, 300).value, kMeanPistonEnergy, kRounding);
    // Its rate of change is the energy current; the quotient's own error is of order kSoon.
    constexpr double kSoon = 1e-5;
    EXPECT_NEAR((Spectrum().MeanEnergy(epsilon, kSoon).value - epsilon) / kSoon,
                PairEnergyCurrent(epsilon), 3e-6)
        << epsilon;
    for (double t = 0; t < 60; t += 0.5) {
      const double energy = Spectrum().MeanEnergy(epsilon, t).value;
      EXPECT_GT(energy, -kRounding);
      EXPECT_LT(energy, 0.5 + kRounding);
    }
  }
}

// ---- generator.h ----

const Generator& InUse() {
  static const auto* const generator = new Generator({});
  return *generator;
}

// (L g)(u) by quadrature: with u' = s sin(phi) the kernel is max(u, u')/(sqrt(2) pi). Cut where the
// maximum changes sides, and graded to where g has its singularities.
double ApplyL(const std::function<double(double)>& g, double u) {
  const double s = std::sqrt((1 - u) * (1 + u));
  const auto integrand = [&](Quad phi) {
    const double v = s * std::sin(static_cast<double>(phi));
    return Quad{std::max(u, v) * (g(std::min(v, 1.0)) - g(u)) / (M_SQRT2 * M_PI)};
  };
  std::vector<double> cuts = {0, M_PI / 2};
  const auto cut = [&](double v) {
    if (v > 0 && v < s) cuts.push_back(std::asin(v / s));
  };
  cut(u);
  for (int k = 0; k < 12; ++k) {
    const double step = std::pow(0.2, k);
    cut(0.5 * step), cut(M_SQRT1_2 - 0.3 * step), cut(M_SQRT1_2 + 0.2 * step), cut(1 - 0.1 * step);
  }
  cut(M_SQRT1_2);
  std::sort(cuts.begin(), cuts.end());
  Quad sum = 0;
  for (size_t i = 0; i + 1 < cuts.size(); ++i) {
    sum += oracle::Integrate(integrand, cuts[i], cuts[i + 1]);
  }
  return static_cast<double>(sum);
}

TEST(Generator, ConservesProbability) {
  for (const int degree : {1, 2, 6, 10, 12}) {
    for (const int levels : {1, 3, 5}) {
      const Generator generator({.degree = degree, .levels = levels});
      EXPECT_EQ(generator.size(), 4 * (levels + 1) * (degree + 1));
      const Eigen::VectorXd one = generator.Coefficients([](double) { return 1.0; });
      EXPECT_LE(generator.rates().cwiseProduct(one).norm(), kGeneratorRoundingError)
          << degree << " " << levels;
      EXPECT_LE(generator.asymmetry(), kGeneratorRoundingError) << degree << " " << levels;
      EXPECT_NEAR(generator.rates()[0], 0, kGeneratorRoundingError);
      EXPECT_GT(generator.rates()[1], 0.15);
    }
  }
}

// The expansion's dE[ep(t)]/dt is equal to L applied to E[ep(t)] by quadrature: the backward
// equation, from time 0 to times at which only the gap's function remains.
TEST(Generator, EvolutionObeysTheMasterEquation) {
  const Eigen::VectorXd energy = InUse().Coefficients([](double u) { return u * u / 2; });
  for (const double t : {0.0, 1.0, 5.0, 20.0, 60.0}) {
    const Eigen::VectorXd decayed =
        energy.cwiseProduct((-InUse().rates() * t).array().exp().matrix());
    const auto mean = [&](double u) { return decayed.dot(InUse().At(u)); };
    const double scale = std::exp(-0.152 * t);
    for (const double u : {0.0, 0.01, 0.2, 0.5, 0.7, M_SQRT1_2, 0.71, 0.9, 0.99, 1.0}) {
      const double derivative = -decayed.cwiseProduct(InUse().rates()).dot(InUse().At(u));
      EXPECT_NEAR(ApplyL(mean, u), derivative, 1e-8 * scale) << "t " << t << ", u " << u;
    }
  }
}

}  // namespace
}  // namespace ballpiston
