#include "core/markov/energy_distribution.h"

#include <cmath>

namespace ballpiston {

EnergyDistribution EnergyDistribution::WithDensity(const Generator& generator,
                                                   const std::function<double(double)>& density) {
  const EnergyDistribution given(generator, generator.Coefficients(density));
  const double total = given.Average([](double) { return 1.0; });
  return {generator, given.coefficients_ / total};
}

EnergyDistribution EnergyDistribution::At(const Generator& generator, double epsilon) {
  return {generator, generator.At(std::sqrt(2 * epsilon))};
}

EnergyDistribution EnergyDistribution::After(double time) const {
  const Eigen::ArrayXd decay = (-generator_->rates().array() * time).exp();
  return {*generator_, (coefficients_.array() * decay).matrix()};
}

double EnergyDistribution::Density(double u) const { return coefficients_.dot(generator_->At(u)); }

double EnergyDistribution::Average(const std::function<double(double)>& of_u) const {
  return coefficients_.dot(generator_->Coefficients(of_u));
}

double EnergyDistribution::MeanEnergy() const {
  return Average([](double u) { return u * u / 2; });
}

}  // namespace ballpiston
