#include "core/statistics/batch_means.h"

#include <cmath>

namespace ballpiston {

void BatchMeans::Add(double numerator, double denominator) {
  BatchMeans one = {.mean_denominator = denominator};
  one.numerator.Add(numerator);
  Merge(one);
}

void BatchMeans::Merge(const BatchMeans& other) {
  if (other.batches() == 0) return;
  if (batches() == 0) {
    *this = other;
    return;
  }
  const double na = static_cast<double>(batches()), nb = static_cast<double>(other.batches());
  const double dn = other.numerator.mean - numerator.mean;
  const double dd = other.mean_denominator - mean_denominator;
  const double weight = na * nb / (na + nb);
  numerator.Merge(other.numerator);
  c_nd += other.c_nd + weight * dn * dd;
  c_dd += other.c_dd + weight * dd * dd;
  mean_denominator += dd * nb / (na + nb);
}

std::optional<double> BatchMeans::Ratio() const {
  if (batches() == 0 || mean_denominator == 0) return std::nullopt;
  return numerator.mean / mean_denominator;
}

std::optional<double> BatchMeans::StandardError() const {
  if (batches() < 2 || mean_denominator == 0) return std::nullopt;
  const double ratio = *Ratio();
  const double n = static_cast<double>(batches());
  const double scatter = numerator.m2 - 2 * ratio * c_nd + ratio * ratio * c_dd;
  return std::sqrt(std::fmax(scatter, 0) / (n * (n - 1))) / std::fabs(mean_denominator);
}

}  // namespace ballpiston
