// The statistical noise of the count n of one cell, which has probability q, in N samples: the
// moments of n log(n/mu), mu = N q. Their sums over all cells give the noise of a relative entropy.
//
// The sum over all cells is H = sum of h, h = n log(n/mu) - (n - mu). The mean of H is computed
// from the binomial counts, exactly. The variance is that of independent Poisson counts, given that
// their sum T is N. It follows from an expansion of E(H | T) about N. The slope is that of E(H) in
// N, covariance/N; the curvature c is that of E(H) plus 1/N. T has variance N, so
//   variance(H | T = N) = variance - covariance^2/N - (N c)^2/2.
// With many samples per cell this tends to (cells - 1)/2, as for a chi-squared law.
#pragma once

namespace ballpiston {

// Summed over cells.
struct CellNoise {
  double mean = 0;        // of n log(n/mu), for binomial counts; exact to 1e-4 of itself
  double squared = 0;     // mean of n log^2(n/mu)
  double variance = 0;    // of h, for Poisson counts, like the rest
  double covariance = 0;  // of h and n
  double curvature = 0;   // N d/dN (covariance/N)

  void Add(const CellNoise& other);
  CellNoise Times(double cells) const;
  double VarianceOfSum(double samples) const;  // given T = samples
};

// samples 0 (no noise) or at least 1, 0 < probability <= 1.
CellNoise NoiseOfCell(double samples, double probability);

}  // namespace ballpiston
