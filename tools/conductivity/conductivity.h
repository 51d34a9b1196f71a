// The conductivity of infinite chains and lattices (core/conductivity/conductivity.h), computed by
// Varadhan's variational formula, which is exact for a reversible process: with the field X =
// sum(x e), and f any function of finitely many energies, summed over all its translates,
//
//   kappa T^2 = (1/2) inf_f sum over the contacts c of a cell < rate_c (delta_c (X + f))^2 >
//             = inf_f ( E + 2 b f + f A f ) = E - b A^-1 b,
//
// where delta_c is the change by an exchange, and galerkin_form.h defines A, b and E. f = 0 gives
// the static conductivity kappa_0. Every finite set of functions gives an upper bound,
//
//   kappa/kappa_0 - 1 <= -b A^-1 b/E
//
// with f the polynomials of a total degree n on clusters of neighbouring sites. As n grows, the
// bound tends to its limit with the power of tail_limit.h. A refinement has steps: first a small
// cluster with high degrees, then the contributions of larger clusters, with lower degrees. Each
// step is extrapolated in n. The last step gives an estimate for still larger clusters.
//
// Units: lengths in E, A and b are distances of neighbouring sites; the ratio has no unit.
// Properties, each with the test that bears its name:
//   1. StaticConductivityIsHalfTheExchangeRate.  2. FunctionsOfOnePairHaveTheirKnownValues.
//   3. SpheresHaveThePublishedValue: Gaspard and Gilbert, Dynamical contribution to the heat
//      conductivity in stochastic energy exchanges of locally confined gases (2017), -0.000373. The
//      value here, -0.000372458, agrees within one unit of the last digit.
//   4. QuickPlanAgreesWithTheConstants, and by night FinePlanGivesTheConstants.
#pragma once

#include <vector>

#include "tools/conductivity/cluster_basis.h"
#include "tools/conductivity/site_lattice.h"
#include "tools/conductivity/tail_limit.h"

namespace ballpiston {

// `extent` is the number of neighbouring sites in a chain. In the lattice it is the greatest
// |x| + |y| from a ball or a piston. A function depends on up to `sites` of these sites.
struct ClusterSize {
  int extent;
  int sites;

  friend bool operator==(const ClusterSize&, const ClusterSize&) = default;
};

// kappa/kappa_0 - 1 on the polynomials of this degree, an upper bound. Domain: degree 1 to 40 for
// balls and pistons, 24 for equal sites; extent 1 or more. Relative error 1e-9, for rounding.
double ConductivityBound(const SiteLattice& lattice, ClusterSize size, int degree);

// The step from one cluster to a larger one. The correction changes by a limit that is extrapolated
// from these degrees. In the first step `from.extent` is 0: there is no smaller cluster.
struct RefinementStep {
  ClusterSize from;
  ClusterSize to;
  std::vector<int> degrees;  // two or more, ascending
};

struct RefinementPlan {
  std::vector<RefinementStep> steps;
  double beyond;  // contribution of still larger clusters, divided by that of the last step
};

struct ComputedBound {
  ClusterSize size;
  int degree;
  double correction;
};

struct ConductivityRatio {
  double correction;   // extrapolated kappa/kappa_0 - 1
  double error;        // sum of all steps' errors and half of the contribution beyond
  double upper_bound;  // the least bound that was computed
  std::vector<ComputedBound> table;
};

ConductivityRatio RefineConductivity(const SiteLattice& lattice, const RefinementPlan& plan);

RefinementPlan QuickPlan(const SiteLattice& lattice);  // 0.2 to 0.5 s
RefinementPlan FinePlan(const SiteLattice& lattice);   // 15 to 30 s

// The corrections of chains of equal sites, discs and spheres, by FinePlan.
inline constexpr BoundedValue kDiscChainCorrection = {-0.00089895, 6e-8};
inline constexpr BoundedValue kSphereChainCorrection = {-0.000372458, 8e-9};

}  // namespace ballpiston
