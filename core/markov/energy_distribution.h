// A distribution of the pair's energies and its course under the master equation, eq. meq.
//
// Given by a density over u = sqrt(2 ep), the piston's speed, on [0, 1]; the stationary one is 1.
// Kept as coefficients by eigenfunction, each of which decays at its own rate:
//   P(u, t) = sum_k p_k function_k(u) exp(-rate_k t)
//
// Units: times |G|/|dG_bp|. Properties, each with a test of its name:
//   1. KeepsItsTotalProbability.
//   2. StepsAddUp: After(s).After(t) is After(s + t), to rounding.
//   3. ForgetsWhereItBegan: the density tends to 1, the mean energy to 1/6.
//   4. FollowsTheKernel: the density's slope at t = 0 is gain less loss, by quadrature over K.
//
// Immutable; the generator has to outlive it.
#ifndef BALLPISTON_CORE_MARKOV_ENERGY_DISTRIBUTION_H_
#define BALLPISTON_CORE_MARKOV_ENERGY_DISTRIBUTION_H_

#include <functional>
#include <utility>

#include "core/markov/generator.h"

namespace ballpiston {

class EnergyDistribution {
 public:
  // Scaled to total 1. The density may have kinks at 0, 1/sqrt(2) and 1, not elsewhere; its
  // integral is above 0.
  static EnergyDistribution WithDensity(const Generator& generator,
                                        const std::function<double(double)>& density);
  // All at one energy, in [0, 1/2]: of this only averages of smooth functions mean something, as
  // what has not jumped yet stays at that energy.
  static EnergyDistribution At(const Generator& generator, double epsilon);

  EnergyDistribution After(double time) const;  // time >= 0

  double Density(double u) const;
  double Average(const std::function<double(double)>& of_u) const;
  double MeanEnergy() const;  // of the piston

 private:
  EnergyDistribution(const Generator& generator, Eigen::VectorXd coefficients)
      : generator_(&generator), coefficients_(std::move(coefficients)) {}

  const Generator* generator_;
  Eigen::VectorXd coefficients_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_MARKOV_ENERGY_DISTRIBUTION_H_
