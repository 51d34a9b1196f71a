// Relaxation of the piston's energy in the limit of rare collisions, from the generator's spectrum.
//
//   C(t) = <ep(0) ep(t)> - <ep>^2 = sum_k c_k^2 exp(-rate_k t),   c_k = <function_k, ep>
//   int_0^inf C dt/C(0) = sum_k c_k^2/rate_k / C(0)               the integral time
//   E[ep(t) | u at 0] = sum_k c_k function_k(u) exp(-rate_k t)
//
// in equilibrium, where <ep> = 1/6 and C(0) = 1/45. The eigenfunctions are those of generator.h.
// The spectral gap is the least rate above 0, the rate of relaxation at long times. Only 1 % of the
// initial energy correlation decays at this rate; most of it decays faster, in the continuum.
//
// Units: rates |dG_bp|/|G|, times |G|/|dG_bp|. A stated error is a bound for all epsilons and
// times, at least five times the largest error found: the difference from another discretisation
// would be 0 wherever the two cross. Properties, each with a test of its name:
//   1. StatedErrorsAreUpperBounds.  2. MeanEnergyRelaxesFromTheInitialEnergy.
//
// Immutable; safe to share between threads.
#pragma once

#include <vector>

#include "core/arithmetic/bounded_value.h"
#include "core/markov/generator.h"

namespace ballpiston {

inline constexpr double kMeanPistonEnergy = 1.0 / 6;
inline constexpr double kVarianceOfPistonEnergy = 1.0 / 45;

// Bounds of the errors, with the largest one found on 2,000 epsilons by the same method in 64-bit
// mantissas, at degree 20 on 8 levels. None is below the least error of a mean, 3e-14 of the value
// (statistics/stated_error.h).
inline constexpr double kRateError = 3e-14;             // 2.4e-15
inline constexpr double kAutocorrelationError = 3e-14;  // 2.3e-15
inline constexpr double kCorrelationTimeError = 1e-13;  // 1.6e-15
inline constexpr double kMeanEnergyError = 1e-10;       // 1.9e-11, by rounding, at epsilon = 1/2
inline constexpr double kDecayIntegralError = 1e-9;     // 1.2e-10, at epsilon = 0.22

class RelaxationSpectrum {
 public:
  explicit RelaxationSpectrum(const Discretisation& discretisation);

  // The instance in use, whose errors are bounded. The first call computes it, in about 0.1 s.
  static const RelaxationSpectrum& Get();

  BoundedValue Gap() const;
  // The first five isolated rates below the continuum, ascending; the gap is the first. There are
  // more isolated rates; they accumulate at the bottom of the continuum.
  std::vector<BoundedValue> IsolatedRates() const;

  // C(t)/C(0), t >= 0.
  BoundedValue Autocorrelation(double t) const;
  // int_0^window C dt/C(0); window may be infinite.
  BoundedValue CorrelationTime(double window) const;
  // E[ep(t)] from `epsilon` in [0, 1/2].
  BoundedValue MeanEnergy(double epsilon, double t) const;
  // int_0^window (E[ep(t)] - 1/6) dt; window may be infinite.
  BoundedValue DecayIntegral(double epsilon, double window) const;

 private:
  // C/C(0), and E[ep] - 1/6 from epsilon: sums over the eigenfunctions, each with a factor.
  double Correlation(const Eigen::ArrayXd& factors) const;
  double Energy(double epsilon, const Eigen::ArrayXd& factors) const;
  // The factors exp(-rate t), and their integrals from 0 to `window`.
  Eigen::ArrayXd At(double t) const;
  Eigen::ArrayXd Until(double window) const;

  Generator generator_;
  Eigen::VectorXd energy_;  // coefficients of ep - 1/6
};

}  // namespace ballpiston
