#include "core/markov/relaxation_spectrum.h"

#include <cmath>

namespace ballpiston {
namespace {

constexpr Discretisation kInUse = {.degree = 10, .levels = 5};
constexpr double kTold = 1e-8;

double SquareRootOfTwice(double epsilon) { return std::sqrt(2 * epsilon); }

// Without the stationary law, whose rate is 0.
auto Decaying(const Eigen::VectorXd& values) { return values.tail(values.size() - 1).array(); }

Discretisation Coarser(const Discretisation& fine) {
  return {.degree = fine.degree - 2, .levels = fine.levels - 1};
}

}  // namespace

RelaxationSpectrum::Level::Level(const Discretisation& discretisation)
    : generator(discretisation),
      energy(generator.Coefficients([](double u) { return u * u / 2 - kMeanPistonEnergy; })) {}

double RelaxationSpectrum::Level::Correlation(const Eigen::ArrayXd& factors) const {
  return (Decaying(energy).square() * factors).sum() / kVarianceOfPistonEnergy;
}

double RelaxationSpectrum::Level::Energy(double u, const Eigen::ArrayXd& factors) const {
  return (Decaying(energy) * Decaying(generator.At(u)) * factors).sum();
}

Eigen::ArrayXd RelaxationSpectrum::Level::At(double t) const {
  return (-Decaying(generator.rates()) * t).exp();
}

Eigen::ArrayXd RelaxationSpectrum::Level::Until(double window) const {
  const Eigen::ArrayXd rates = Decaying(generator.rates());
  if (std::isinf(window)) return 1 / rates;
  return -(-rates * window).unaryExpr([](double x) { return std::expm1(x); }) / rates;
}

RelaxationSpectrum::RelaxationSpectrum(const Discretisation& discretisation)
    : fine_(discretisation), coarse_(Coarser(discretisation)) {}

const RelaxationSpectrum& RelaxationSpectrum::Get() {
  static const auto* const spectrum = new RelaxationSpectrum(kInUse);
  return *spectrum;
}

template <typename Value>
SpectralValue RelaxationSpectrum::Compared(Value value) const {
  const double fine = value(fine_);
  return {fine, std::fabs(fine - value(coarse_))};
}

SpectralValue RelaxationSpectrum::Gap() const {
  return Compared([](const Level& level) { return level.generator.rates()[1]; });
}

std::vector<SpectralValue> RelaxationSpectrum::IsolatedRates() const {
  std::vector<SpectralValue> rates;
  for (Eigen::Index k = 1; k < coarse_.generator.size(); ++k) {
    const SpectralValue rate =
        Compared([k](const Level& level) { return level.generator.rates()[k]; });
    if (rate.error > kTold || rate.value >= kContinuumBottom) break;
    rates.push_back(rate);
  }
  return rates;
}

SpectralValue RelaxationSpectrum::Autocorrelation(double t) const {
  return Compared([t](const Level& level) { return level.Correlation(level.At(t)); });
}

SpectralValue RelaxationSpectrum::CorrelationTime(double window) const {
  return Compared([window](const Level& level) { return level.Correlation(level.Until(window)); });
}

SpectralValue RelaxationSpectrum::MeanEnergy(double epsilon, double t) const {
  const double u = SquareRootOfTwice(epsilon);
  return Compared(
      [u, t](const Level& level) { return kMeanPistonEnergy + level.Energy(u, level.At(t)); });
}

SpectralValue RelaxationSpectrum::DecayIntegral(double epsilon, double window) const {
  const double u = SquareRootOfTwice(epsilon);
  return Compared([u, window](const Level& level) { return level.Energy(u, level.Until(window)); });
}

}  // namespace ballpiston
