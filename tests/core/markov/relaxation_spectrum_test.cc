#include "core/markov/relaxation_spectrum.h"

#include <Eigen/Eigenvalues>

#include "core/closed_form/kernel.h"
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

TEST(RelaxationSpectrum, GapAgreesBetweenDiscretisations) {
  const SpectralValue gap = Spectrum().Gap();
  EXPECT_NEAR(gap.value, 0.1520871266135, 5e-14);  // what degree 16 on 8 levels gives, rounded
  for (const Discretisation& other :
       {Discretisation{8, 5}, {10, 4}, {12, 5}, {12, 6}, {14, 4}, {16, 6}}) {
    EXPECT_NEAR(Generator(other).rates()[1], gap.value, kRateError)
        << other.degree << " " << other.levels;
  }
}

// Against a finer discretisation, at epsilons inside and at the ends of the elements. A bound is at
// least the least error of a mean.
TEST(RelaxationSpectrum, StatedErrorsAreUpperBounds) {
  const RelaxationSpectrum finer({.degree = 18, .levels = 5});
  const auto expect_bound = [](const SpectralValue& value, const SpectralValue& truth) {
    EXPECT_LE(std::fabs(value.value - truth.value), value.error);
    EXPECT_GE(value.error, (1 - 1e-12) * kRoundingOfAMean * std::fabs(value.value));
  };
  const std::vector<SpectralValue> rates = Spectrum().IsolatedRates();
  for (size_t k = 0; k < rates.size(); ++k) expect_bound(rates[k], finer.IsolatedRates()[k]);
  std::vector<double> epsilons = {1e-12, 0.0005, 0.09875, 0.19, 0.2205, 0.255, 0.4266, 0.49999};
  for (int i = 0; i <= 200; ++i) epsilons.push_back(0.0025 * i);
  for (const double t : {0.0, 0.3, 3.0, 6.0, 16.0, 32.0, kForEver}) {
    expect_bound(Spectrum().CorrelationTime(t), finer.CorrelationTime(t));
    for (const double epsilon : epsilons) {
      SCOPED_TRACE(epsilon);
      expect_bound(Spectrum().DecayIntegral(epsilon, t), finer.DecayIntegral(epsilon, t));
      if (t == kForEver) continue;
      const SpectralValue exact = t == 0 ? SpectralValue{epsilon, 0} : finer.MeanEnergy(epsilon, t);
      expect_bound(Spectrum().MeanEnergy(epsilon, t), exact);
    }
  }
  for (double t = 0; t < 40; t += 0.1) {
    expect_bound(Spectrum().Autocorrelation(t), finer.Autocorrelation(t));
  }
}

TEST(RelaxationSpectrum, IsolatedRatesAscendBelowTheContinuum) {
  const std::vector<SpectralValue> rates = Spectrum().IsolatedRates();
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

// The generator on n equal cells of u: a slow, independent discretisation. The rate density u -> u'
// is integrated over rectangles [0, a] x [0, b] by areas under a circle, and a cell's rows sum to
// the rate at which it is left. The result is the three least rates above 0, the two largest, and
// the correlation time.
Eigen::VectorXd ByEqualCells(Eigen::Index n) {
  const auto area = [](double x, double c) {  // int_0^min(x, c) sqrt(c^2 - t^2) dt
    x = std::min(x, c);
    const double height = std::sqrt((c - x) * (c + x));
    return (x * height + c * c * std::atan2(x, height)) / 2;
  };
  const double cells = static_cast<double>(n);
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(n + 1, 0, 1);
  const auto rate = [&](Eigen::Index i, Eigen::Index k) {
    const double m = std::min(u[i], u[k]);
    return (2 * area(m, M_SQRT1_2) - M_SQRT1_2 * (area(m, std::sqrt(1 - u[i] * u[i])) +
                                                  area(m, std::sqrt(1 - u[k] * u[k])))) /
           M_PI;
  };
  const Eigen::MatrixXd up_to = Eigen::MatrixXd::NullaryExpr(n + 1, n + 1, rate);
  Eigen::MatrixXd minus_l = cells * (up_to.topRightCorner(n, n) + up_to.bottomLeftCorner(n, n) -
                                     up_to.topLeftCorner(n, n) - up_to.bottomRightCorner(n, n));
  minus_l.diagonal() -= minus_l.rowwise().sum();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(minus_l);
  const Eigen::VectorXd& rates = solver.eigenvalues();
  const Eigen::VectorXd cubes = u.array().cube() / 6;  // int_0^u of the energy
  const Eigen::VectorXd energy =
      solver.eigenvectors().transpose() * (cubes.tail(n) - cubes.head(n));
  Eigen::VectorXd found(6);
  found << rates.segment(1, 3), rates.tail(2),
      45 * cells * energy.tail(n - 1).cwiseAbs2().cwiseQuotient(rates.tail(n - 1)).sum();
  return found;
}

// Extrapolated from 100, 200 and 400 cells, with errors 1/n^2 and 1/n^3.
TEST(RelaxationSpectrum, RatesAndCorrelationTimeAreThoseOfEqualCells) {
  const Eigen::VectorXd coarse = ByEqualCells(100), middle = ByEqualCells(200),
                        fine = ByEqualCells(400);
  const Eigen::VectorXd first = middle + (middle - coarse) / 3, second = fine + (fine - middle) / 3;
  const Eigen::VectorXd limit = second + (second - first) / 7;
  const Eigen::VectorXd rates = Generator({}).rates();
  Eigen::VectorXd exact(6);
  exact << rates.segment(1, 3), rates.tail(2), Spectrum().CorrelationTime(kForEver).value;
  constexpr double kErrors[] = {1e-8, 3e-7, 3e-6, 1e-6, 1e-6, 3e-8};
  for (Eigen::Index k = 0; k < 6; ++k) EXPECT_NEAR(limit[k], exact[k], kErrors[k]) << k;
}

// <h> over the stationary law, uniform in u. At u = 1/sqrt(2) h has powers of a square root.
double MeanSquaredTransfer() {
  const auto h = [](Quad u) {
    return PairSquaredEnergyTransfer(std::pow(static_cast<double>(u), 2) / 2);
  };
  return static_cast<double>(oracle::IntegrateToRoot(h, 0, M_SQRT1_2) +
                             oracle::Integrate(h, Quad{M_SQRT1_2}, 1));
}

// In equilibrium C(t + s) = <E[ep(t)|u at 0] E[ep(s)|u at 0]> - 1/36: reversibility and the
// semigroup at once.
TEST(RelaxationSpectrum, AutocorrelationSatisfiesSemigroupAndInitialSlope) {
  for (const double t : {0.0, 1.0, 4.0, 20.0}) {
    for (const double s : {0.5, 4.0, 15.0}) {
      const auto product = [&](Quad x) {
        const double ep = std::pow(static_cast<double>(x), 2) / 2;
        return (Spectrum().MeanEnergy(ep, t).value - kMeanPistonEnergy) *
               (Spectrum().MeanEnergy(ep, s).value - kMeanPistonEnergy);
      };
      const Quad cuts[] = {0, 0.05, 0.4, 0.65, M_SQRT1_2, 0.76, 0.95, 1};
      Quad sum = 0;
      for (size_t i = 0; i + 1 < std::size(cuts); ++i) {
        sum += oracle::Integrate(product, cuts[i], cuts[i + 1]);
      }
      EXPECT_NEAR(static_cast<double>(sum) / kVarianceOfPistonEnergy,
                  Spectrum().Autocorrelation(t + s).value, 1e-9)
          << t << " + " << s;
    }
  }
  // C'(0) = <ep L ep> = -<h>/2; the difference quotient's own error is of order t.
  const double slope = -MeanSquaredTransfer() / 2 / kVarianceOfPistonEnergy;
  constexpr double kStep = 1e-4;
  const double quotient = (-3 + 4 * Spectrum().Autocorrelation(kStep).value -
                           Spectrum().Autocorrelation(2 * kStep).value) /
                          (2 * kStep);
  EXPECT_NEAR(quotient, slope, 1e-8);
  EXPECT_LT(Spectrum().Autocorrelation(35).value, 1e-3);
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

}  // namespace
}  // namespace ballpiston
