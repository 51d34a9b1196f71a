#include "core/markov/generator.h"

#include "core/closed_form/kernel.h"
#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"

namespace ballpiston {
namespace {

const Generator& InUse() {
  static const auto* const generator = new Generator({});
  return *generator;
}

Eigen::VectorXd EnergyOf(const Generator& generator) {
  return generator.Coefficients([](double u) { return u * u / 2; });
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
  const Eigen::VectorXd energy = EnergyOf(InUse());
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
