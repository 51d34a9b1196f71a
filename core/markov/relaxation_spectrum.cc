#include "core/markov/relaxation_spectrum.h"

#include <cmath>

namespace ballpiston {
namespace {

constexpr Discretisation kInUse = {.degree = 14, .levels = 5};
constexpr Eigen::Index kIsolatedRates = 5;

// Without the stationary law, whose rate is 0.
auto Decaying(const Eigen::VectorXd& values) { return values.tail(values.size() - 1).array(); }

}  // namespace

RelaxationSpectrum::RelaxationSpectrum(const Discretisation& discretisation)
    : generator_(discretisation),
      energy_(generator_.Coefficients([](double u) { return u * u / 2 - kMeanPistonEnergy; })) {}

const RelaxationSpectrum& RelaxationSpectrum::Get() {
  static const auto* const spectrum = new RelaxationSpectrum(kInUse);
  return *spectrum;
}

double RelaxationSpectrum::Correlation(const Eigen::ArrayXd& factors) const {
  return (Decaying(energy_).square() * factors).sum() / kVarianceOfPistonEnergy;
}

double RelaxationSpectrum::Energy(double epsilon, const Eigen::ArrayXd& factors) const {
  return (Decaying(energy_) * Decaying(generator_.At(std::sqrt(2 * epsilon))) * factors).sum();
}

Eigen::ArrayXd RelaxationSpectrum::At(double t) const {
  return (-Decaying(generator_.rates()) * t).exp();
}

Eigen::ArrayXd RelaxationSpectrum::Until(double window) const {
  const Eigen::ArrayXd rates = Decaying(generator_.rates());
  if (std::isinf(window)) return 1 / rates;
  return -(-rates * window).unaryExpr([](double x) { return std::expm1(x); }) / rates;
}

BoundedValue RelaxationSpectrum::Gap() const { return IsolatedRates().front(); }

std::vector<BoundedValue> RelaxationSpectrum::IsolatedRates() const {
  std::vector<BoundedValue> rates;
  for (Eigen::Index k = 1; k <= kIsolatedRates; ++k) {
    rates.push_back({generator_.rates()[k], kRateError});
  }
  return rates;
}

BoundedValue RelaxationSpectrum::Autocorrelation(double t) const {
  return {Correlation(At(t)), kAutocorrelationError};
}

BoundedValue RelaxationSpectrum::CorrelationTime(double window) const {
  return {Correlation(Until(window)), kCorrelationTimeError};
}

BoundedValue RelaxationSpectrum::MeanEnergy(double epsilon, double t) const {
  return {kMeanPistonEnergy + Energy(epsilon, At(t)), kMeanEnergyError};
}

BoundedValue RelaxationSpectrum::DecayIntegral(double epsilon, double window) const {
  return {Energy(epsilon, Until(window)), kDecayIntegralError};
}

}  // namespace ballpiston
