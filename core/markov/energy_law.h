// The law of the piston's energy at time t where ball and piston rarely meet, from a start at one
// energy: the solution of the master equation (eq. meq), integrated over bins.
//
// With u = sqrt(2 ep), r the jump rate and K the kernel of generator.h, the law at time t is the
// sum of what has not jumped, has jumped once, and has jumped more often:
//   exp(-r(u) t) delta(u' - u) + K(u, u') E(r(u), r(u'))
//     + sum_k (K function_k)(u) (K function_k)(u') E(r(u), rate_k, r(u'))
// where E is the integral of exp(-rates * durations) over all durations that sum to t, up to a sign
// a divided difference of exp(-x t). The mass at u and the kernel's singularity are in the first
// two terms, exactly; a sum of eigenfunctions alone is wrong by percents. The third term converges
// slowly where u' is near u, because both kernels are singular at sqrt(1 - u^2).
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

inline constexpr double kEnergyLawError = 1e-3;  // of a probability; 4e-4 were seen

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

  double Edge(size_t bin) const;  // in u
  Node NodeBetween(size_t bin, double u, double other_u) const;
  void AddOneJump(double u, double t, std::vector<double>& law) const;
  void AddMoreJumps(double u, double t, std::vector<double>& law) const;

  Generator generator_;
  size_t bins_;
  std::vector<Node> nodes_;
};

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_MARKOV_ENERGY_LAW_H_
