// The law of the piston's energy at time t where ball and piston rarely meet, from a start at one
// energy: the solution of the master equation (eq. meq), integrated over bins.
//
// With u = sqrt(2 ep), r the jump rate and K the kernel of generator.h, the law at time t is the
// sum of what has jumped never, once, twice, and more often:
//   exp(-r(u) t) delta(u' - u) + K(u, u') E(r(u), r(u')) + int K(u, v) K(v, u') E(r(u), r(v),
//   r(u')) dv
//     + sum_k (K f_k)(u) (K f_k)(u') E(r(u), rate_k, r(u')) - the same sum of the multiplication by
//     r
// where E is the integral of exp(-rates * durations) over all durations that sum to t, up to a sign
// a divided difference of exp(-x t), and f_k, rate_k are the eigenfunctions of the generator. The
// mass at u and the kernel's singularities are in the first three terms, by quadrature. The last
// two are each wrong by percents where u' is near u, because K(u, .) is singular and has no good
// expansion in the f_k; their difference, which has a jump more between the two kernels, is not.
//
// Units: times |G|/|dG_bp|. Properties, each with a test of its name:
//   1. SumsToOneAtAllTimes.  2. BecomesTheStationaryLaw.  3. MeanIsTheSpectrums.
//   4. FollowsTheKernelAtShortTimes.
//   5. DiffersBetweenDiscretisationsByLessThanItsBound, kEnergyLawError.
// Immutable; safe to share between threads.
#ifndef BALLPISTON_CORE_MARKOV_ENERGY_LAW_H_
#define BALLPISTON_CORE_MARKOV_ENERGY_LAW_H_

#include <Eigen/Core>
#include <vector>

#include "core/markov/generator.h"

namespace ballpiston {

inline constexpr double kEnergyLawError = 1e-4;  // of a probability; 5e-5 were seen

class EnergyLaw {
 public:
  // Equal bins of the energy over [0, 1/2].
  EnergyLaw(const Discretisation& discretisation, int bins);

  // Of each bin, for epsilon in [0, 1/2] and t >= 0.
  std::vector<double> Probabilities(double epsilon, double t) const;

 private:
  // Of an integral over a bin of gains times a function that is smooth there: the function is taken
  // at the nodes, and interpolated linearly between them.
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
  void AddTwoJumps(double u, double t, std::vector<double>& law) const;
  // Two jumps or more by the generator; exactly two by its losses alone.
  void AddModes(const Modes& modes, double sign, double u, double t,
                std::vector<double>& law) const;

  size_t bins_;
  std::vector<double> middle_rates_;  // of jumps, in the middle of each bin
  Modes all_, losses_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_MARKOV_ENERGY_LAW_H_
