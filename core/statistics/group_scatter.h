// How much more the counts of correlated samples scatter than those of independent samples.
//
// The samples of an orbit are correlated, orbits are not. Orbits are dealt to kGroups groups, and
// each group has its own counts. Let d_gc be the count of group g in cell c less the group's share
// of all counts n_c, and
//   Q_gh = sum over cells of d_gc d_hc/n_c - sum over rows of d_gr d_hr/n_r.
// Q_gg is a chi-squared of group g, whose mean shows how large the counts' variances are. The
// scatter of Q_gh, g other than h, also shows how the counts of different cells are correlated: it
// is that of the chi-squared of all samples if no orbit contributes much by itself. An orbit that
// stays in a few cells does, which only Q_gg shows. Properties, each with a test of its name:
//   1. IndependentSamplesScatterAsExpected.  2. RepeatedSamplesCountOnce.
//   3. OrbitsThatStayInACellAddTheirOwnScatter.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/statistics/histogram.h"

namespace ballpiston {

inline constexpr size_t kGroups = 16;

// The degrees of freedom of a variance between groups, and of the scatter of Q_gh.
inline constexpr double kFreedomOfGroups = kGroups - 1;
inline constexpr double kFreedomOfPairs = kGroups * (kGroups - 3) / 2.0;

// Relative to independent samples.
struct GroupScatter {
  double chi_squared = 1;  // the mean of a chi-squared
  double of_pairs = 1;     // its variance from pairs of samples in different groups
  double of_orbits = 0;    // its additional variance from orbits that stay in a few cells
};

// Whether every group has samples. Without them the scatter is unknown.
bool HaveSamples(std::span<const Histogram> groups);

// `groups`: kGroups histograms with the same cells, row by row. Requires HaveSamples.
GroupScatter ScatterOfGroups(std::span<const Histogram> groups, size_t rows);

// The variance, over samples of this kind, of the sum of weight[c] n_c with these weights. Requires
// that the sum is 0.
double VarianceBetweenGroups(std::span<const Histogram> groups, std::span<const double> weights);

// The sum of all groups' counts.
std::vector<uint64_t> CountsOf(std::span<const Histogram> groups);

// The degrees of freedom of a + b, two variances with these degrees of freedom (Satterthwaite).
double FreedomOfSum(double a, double freedom_of_a, double b, double freedom_of_b);

}  // namespace ballpiston
