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
// Units: rates |dG_bp|/|G|, times |G|/|dG_bp|. A stated error is the difference from a coarser
// discretisation, which is larger than the true error of the finer one. Properties, each with a
// test of its name:
//   1. GapAgreesBetweenDiscretisations to kSpectralGapError.
//   2. AutocorrelationSatisfiesSemigroupAndInitialSlope: the initial slope is
//      -<h>/2 of the kernel's moments.
//   3. MeanEnergyRelaxesFromTheInitialEnergy.
//
// Immutable; safe to share between threads.
#pragma once

#include <vector>

#include "core/markov/generator.h"

namespace ballpiston {

inline constexpr double kMeanPistonEnergy = 1.0 / 6;
inline constexpr double kVarianceOfPistonEnergy = 1.0 / 45;
inline constexpr double kSpectralGapError = 1e-12;

struct SpectralValue {
  double value;
  double error;  // of the discretisation
};

class RelaxationSpectrum {
 public:
  explicit RelaxationSpectrum(const Discretisation& discretisation);

  // The instance in use. The first call computes it, in about 0.1 s.
  static const RelaxationSpectrum& Get();

  SpectralValue Gap() const;
  // The isolated rates below the continuum whose error is below 1e-8, ascending; the gap is the
  // first. There are more isolated rates; they accumulate at the bottom of the continuum.
  std::vector<SpectralValue> IsolatedRates() const;

  // C(t)/C(0), t >= 0.
  SpectralValue Autocorrelation(double t) const;
  // int_0^window C dt/C(0); window may be infinite.
  SpectralValue CorrelationTime(double window) const;
  // E[ep(t)] from `epsilon` in [0, 1/2].
  SpectralValue MeanEnergy(double epsilon, double t) const;
  // int_0^window (E[ep(t)] - 1/6) dt; window may be infinite.
  SpectralValue DecayIntegral(double epsilon, double window) const;

 private:
  struct Level {
    explicit Level(const Discretisation& discretisation);
    // C/C(0), and E[ep | u at 0] - 1/6: sums over the eigenfunctions, each with a factor.
    double Correlation(const Eigen::ArrayXd& factors) const;
    double Energy(double u, const Eigen::ArrayXd& factors) const;
    // The factors exp(-rate t), and their integrals from 0 to `window`.
    Eigen::ArrayXd At(double t) const;
    Eigen::ArrayXd Until(double window) const;

    Generator generator;
    Eigen::VectorXd energy;  // coefficients of ep - 1/6
  };

  template <typename Value>
  SpectralValue Compared(Value value) const;

  Level fine_;
  Level coarse_;
};

}  // namespace ballpiston
