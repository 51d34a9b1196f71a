// The law of the piston's energy at time t in the limit of rare collisions, from a given initial
// energy: the solution of the master equation (eq. meq), integrated over bins.
//
// With u = sqrt(2 ep), r the jump rate and K the kernel of generator.h, the law at time t is the
// sum over the number of jumps: none, one, two, and more:
//   exp(-r(u) t) delta(u' - u)
//   + K(u, u') E(r(u), r(u'))
//   + int K(u, v) K(v, u') E(r(u), r(v), r(u')) dv
//   + sum_k (K f_k)(u) (K f_k)(u') E(r(u), rate_k, r(u'))
//   - the same sum over the eigenfunctions of the multiplication by r
// where E is the integral of exp(-rates * durations) over all durations that sum to t (up to its
// sign a divided difference of exp(-x t)), and f_k are the generator's eigenfunctions, with the
// decay rates rate_k. The first three terms contain the mass at u and the kernel's singularities;
// they are computed by quadrature. Each of the last two terms alone is wrong by percents where u'
// is near u, because K(u, .) is singular and has no good expansion in the f_k. Their difference is
// accurate, because it has one more jump between the two kernels. The sum of the terms over all
// bins differs from 1 by up to 3e-4, and the law is divided by it.
//
// Units: times |G|/|dG_bp|. Properties, each with a test of its name:
//   1. MeanAgreesWithTheSpectrum.  2. FollowsTheKernelAtShortTimes.
//   3. SumsToOneAndDiffersFromAFinerLawByLessThanItsBound, kEnergyLawError.
// Immutable; safe to share between threads.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/markov/generator.h"

namespace ballpiston {

// For 61 bins. The largest errors are those of the first bin near epsilon = 1/2: up to 1.5e-4, from
// the rates within the bin; those of other bins and energies are up to 3.5e-5.
inline constexpr Discretisation kEnergyLawDiscretisation = {.degree = 20, .levels = 4};
inline constexpr double kEnergyLawError = 2e-4;  // of a probability

class EnergyLaw {
 public:
  // Equal bins of the energy over [0, 1/2].
  EnergyLaw(const Discretisation& discretisation, int bins);

  // A place after the first jump, with the masses that jump from it into each bin.
  struct FirstJump {
    double rate;    // of jumps from this place
    double weight;  // of this place: quadrature weight times the density of the jump to it
    std::vector<double> into_bins;
  };

  // An initial energy, with the values that are the same for all times.
  struct Start {
    double u;
    size_t bin;
    Eigen::ArrayXd gains, gains_of_losses;
    std::vector<FirstJump> first_jumps;
  };
  Start From(double epsilon) const;  // in [0, 1/2]

  // The probability of each bin, for t from 0 to 1e18.
  std::vector<double> Probabilities(const Start& start, double t) const;

 private:
  // A node of the integral over a bin of gains times a smooth function. The function is taken at
  // the bin's nodes and interpolated linearly between them.
  struct Node {
    size_t bin;
    double rate;           // of jumps, at the node
    Eigen::ArrayXd gains;  // integrated with the node's weight function
  };

  // The modes of a generator, and their gains at the nodes of all bins.
  struct Modes {
    Generator generator;
    std::vector<Node> nodes;
  };

  double Edge(size_t bin) const;  // in u
  Modes ModesOf(Generator generator) const;
  Node NodeBetween(const Generator& generator, size_t bin, double u, double other_u) const;
  void AddOneJump(double u, double t, std::vector<double>& law) const;
  std::vector<FirstJump> FirstJumpsFrom(double u) const;
  void AddTwoJumps(const Start& from, double t, std::vector<double>& law) const;
  // Two jumps or more by the generator; exactly two by its losses alone.
  void AddModes(const Modes& modes, const Eigen::ArrayXd& gains, double u, double t,
                std::vector<double>& law) const;

  size_t bins_;
  std::vector<double> middle_rates_;  // of jumps, in the middle of each bin
  Modes all_, losses_;
};

}  // namespace ballpiston
