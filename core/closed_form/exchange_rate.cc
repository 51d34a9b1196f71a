// Why the static conductivity is half of the exchange rate. Let a ball have temperature T + t/2 and
// a piston T - t/2. To first order in t their canonical density is multiplied by
// 1 + t (eb - ep)/(2 T^2), up to a constant. The mean of the current j over this density is
//
//   <j> = t <(eb - ep) j>/(2 T^2) = t <f>,
//
// by eq. nucanavg, and because <j> = 0 at t = 0. So the thermal conductance of a contact is <f>:
// heat per unit of time and of temperature difference. A ball's centre and the next piston are half
// a cell apart. So if the temperature falls by g from cell to cell, t = g/2, and the current is
// (<f>/2) g.

#include "core/closed_form/exchange_rate.h"

#include <cmath>
#include <numbers>

namespace ballpiston {

CanonicalAverages AveragesAt(double beta) {
  const double mean_f = 1 / std::sqrt(2 * std::numbers::pi * beta);
  const double second = 2 * mean_f / beta / beta;
  return {.mean_f = mean_f, .mean_energy_current = second, .mean_h = second};
}

double ExchangeRate(const PairMeasures& measures, double temperature) {
  return AveragesAt(1 / temperature).mean_f * (measures.area_ball_piston / measures.volume);
}

double RareLimitExchangeRate(double rho, double temperature) {
  return std::sqrt(temperature / std::numbers::pi) / CellArea(rho);
}

double StaticConductivity(double exchange_rate) { return exchange_rate / 2; }

}  // namespace ballpiston
