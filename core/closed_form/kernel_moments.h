// Moments of the stochastic kernel: the rate of collisions of a pair with energies (eb, ep), and
// the moments of the energy zeta that goes from the ball to the piston.
//
//   f(eb, ep) = int W dzeta           rate of collisions           eq. intkernelnuf
//   j(eb, ep) = int zeta W dzeta      energy current               eq. intkerneleta
//   h(eb, ep) = int zeta^2 W dzeta    second moment of transfer    eq. intkerneleta2
//
// Symbols: eb energy of the ball, ep of the piston. Units: |dG_bp|/|G| times energy^(1/2),
// energy^(3/2), energy^(5/2). Domain: eb >= 0, ep >= 0, finite. The Pair functions are f, j, h at
// total energy 1/2, eb = 1/2 - ep, ep in [0, 1/2]. They avoid the rounding of 1/2 - ep, which would
// lose digits near the zero of j.
//
// Properties, each with the test that bears its name:
//   1. AccurateForEveryEnergy: relative error below kKernelMomentsRelativeError; and
//      CurrentIsAccurateThroughItsZero.
//   2. CurrentFlowsToTheSlowPiston: j > 0 exactly when ep < kCurrentZeroRatio eb.
//   3. AreIntegralsOfTheKernel.
// f, j, h scale with the powers 1/2, 3/2, 5/2 of the energies.
//
// Pure functions: safe from any thread.
#pragma once

namespace ballpiston {

inline constexpr double kKernelMomentsRelativeError = 1e-14;

// ep/eb at which the energy current changes sign.
inline constexpr double kCurrentZeroRatio = 0.5404100364603558;

double CollisionRate(double eb, double ep);          // f
double EnergyCurrent(double eb, double ep);          // j
double SquaredEnergyTransfer(double eb, double ep);  // h

double PairCollisionRate(double ep);
double PairEnergyCurrent(double ep);
double PairSquaredEnergyTransfer(double ep);

}  // namespace ballpiston
