#include "core/closed_form/canonical_measure.h"

#include <cmath>
#include <numbers>

namespace ballpiston {

double CanonicalDensity(double beta, double eb, double ep) {
  return beta * std::sqrt(beta / (std::numbers::pi * ep)) * std::exp(-beta * (eb + ep));
}

CanonicalAverages AveragesAt(double beta) {
  const double mean_f = 1 / std::sqrt(2 * std::numbers::pi * beta);
  const double second = 2 * mean_f / beta / beta;
  return {.mean_f = mean_f, .mean_energy_current = second, .mean_h = second};
}

}  // namespace ballpiston
