// The first four central moments of a sample, accumulated in one pass.
//
// The sums are of powers of deviations from the running mean (Pebay's updates). So a large mean or
// many samples cause no cancellation. Property, with a test of its name:
//   1. MergedPassesEqualTwoPasses: merging parts gives the moments of the whole, to rounding; the
//      empty one is an identity bit for bit, on either side.
// Merging the same parts in the same order gives the same bits anywhere.
#pragma once

#include <cstdint>
#include <optional>

namespace ballpiston {

struct Moments {
  uint64_t count = 0;
  double mean = 0;
  double m2 = 0;  // sum of (x - mean)^2, and so on
  double m3 = 0;
  double m4 = 0;

  void Add(double x);
  void Merge(const Moments& other);

  // Unbiased. Requires two samples.
  std::optional<double> Variance() const;
  // The standard error of the mean. Requires two samples.
  std::optional<double> StandardError() const;
  // How many samples of a normal law would give an error of the mean that is as uncertain as
  // StandardError(). The relative variance of an estimated variance is 2/(count - 1) + k/count, k
  // the excess kurtosis, and 2/f with f degrees of freedom (Satterthwaite); the result is f + 1,
  // rounded. It is `count` for k <= 0, and about count/4 for an exponential law, where Student's t
  // with `count` is too narrow: a skewed sample without large values has a small mean and a small
  // error.
  uint64_t EffectiveCount() const;
  // Standard deviation over mean. Requires two samples and a mean other than 0.
  std::optional<double> CoefficientOfVariation() const;
  // The standard error of CoefficientOfVariation, to first order in 1/count (delta method).
  std::optional<double> CoefficientOfVariationError() const;

  friend bool operator==(const Moments&, const Moments&) = default;
};

}  // namespace ballpiston
