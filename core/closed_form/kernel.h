// The stochastic kernel: rate density of collisions after which the piston has the energy ep_out.
//
//   W(eb, ep -> ep_out) = max(sqrt ep_out, sqrt ep)/(2 pi sqrt(ep_out (eb - ep_out)))   eq. kernel
//
// for ep_out < eb, else 0: the piston's new energy is the energy of the ball's normal velocity
// component.
//
// Symbols: eb and ep are the energies of ball and piston before the collision. Units: |dG_bp|/|G|
// over energy^(1/2), per unit of ep_out. Domain: eb, ep, ep_out >= 0, finite. At ep_out = 0 < ep
// the density is infinite (and integrable). PairKernel is the kernel at total energy 1/2,
// eb = 1/2 - ep, with ep and ep_out in [0, 1/2].
//
// Properties, each with the test that bears its name:
//   1. AccurateAtRandomEnergies: relative error below kKernelRelativeError; and for PairKernel
//      AccurateWhereTheBallKeepsLittleEnergy, ep + ep_out -> 1/2.
//   2. AreIntegralsOfTheKernel: with weights 1, zeta, zeta^2, zeta = ep_out - ep, it integrates to
//      the f, j, h of kernel_moments.h.
// Detailed balance: W(eb, ep -> ep_out)/sqrt(ep) is symmetric in ep and ep_out at fixed total
// energy, 1/sqrt(ep) being the microcanonical density.
//
// Pure functions: safe from any thread.
#pragma once

namespace ballpiston {

inline constexpr double kKernelRelativeError = 1e-15;

double Kernel(double eb, double ep, double ep_out);

double PairKernel(double ep, double ep_out);

}  // namespace ballpiston
