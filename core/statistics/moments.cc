#include "core/statistics/moments.h"

#include <cmath>

namespace ballpiston {

void Moments::Add(double x) {
  const double n1 = static_cast<double>(count);
  const double n = static_cast<double>(++count);
  const double d = x - mean;
  const double dn = d / n;
  const double dn2 = dn * dn;
  const double term = d * dn * n1;
  m4 += term * dn2 * (n * n - 3 * n + 3) + 6 * dn2 * m2 - 4 * dn * m3;
  m3 += term * dn * (n - 2) - 3 * dn * m2;
  m2 += term;
  mean += dn;
}

void Moments::Merge(const Moments& other) {
  if (other.count == 0) return;
  if (count == 0) {
    *this = other;
    return;
  }
  const double na = static_cast<double>(count), nb = static_cast<double>(other.count);
  const double n = na + nb;
  const double d = other.mean - mean;
  const double d2 = d * d;
  m4 += other.m4 + d2 * d2 * na * nb * (na * na - na * nb + nb * nb) / (n * n * n) +
        6 * d2 * (na * na * other.m2 + nb * nb * m2) / (n * n) +
        4 * d * (na * other.m3 - nb * m3) / n;
  m3 += other.m3 + d * d2 * na * nb * (na - nb) / (n * n) + 3 * d * (na * other.m2 - nb * m2) / n;
  m2 += other.m2 + d2 * na * nb / n;
  mean += d * nb / n;
  count += other.count;
}

std::optional<double> Moments::Variance() const {
  if (count < 2) return std::nullopt;
  return m2 / static_cast<double>(count - 1);
}

std::optional<double> Moments::StandardError() const {
  if (count < 2) return std::nullopt;
  return std::sqrt(*Variance() / static_cast<double>(count));
}

uint64_t Moments::EffectiveCount() const {
  if (count < 2 || m2 <= 0) return count;
  const double n = static_cast<double>(count);
  const double excess = std::fmax(n * m4 / (m2 * m2) - 3, 0);
  return static_cast<uint64_t>(std::lround(1 + 2 / (2 / (n - 1) + excess / n)));
}

std::optional<double> Moments::CoefficientOfVariation() const {
  if (count < 2 || mean == 0) return std::nullopt;
  return std::sqrt(*Variance()) / mean;
}

std::optional<double> Moments::CoefficientOfVariationError() const {
  if (count < 2 || mean == 0 || m2 <= 0) return std::nullopt;
  // With central moments v, k3, k4 of x: Var(mean) = v/n, Cov(mean, variance) = k3/n and
  // Var(variance) = (k4 - v^2)/n; the ratio's gradient is (-c/mean, 1/(2 mean sqrt(v))).
  const double n = static_cast<double>(count);
  const double v = m2 / n, k3 = m3 / n, k4 = m4 / n;
  const double c2 = v / (mean * mean);
  const double relative = c2 - k3 / (mean * v) + (k4 - v * v) / (4 * v * v);
  return std::sqrt(c2 * std::fmax(relative, 0) / n);
}

}  // namespace ballpiston
