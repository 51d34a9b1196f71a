// The measures of the pair's configuration space as integrals over the piston's position, in
// quadruple precision: no closed form is used, only the curve that bounds the cell.
//
// The upper right disc's arc is (x, y) = (1/2 - rho sin t, 1/2 - rho cos t), t the angle at its
// centre, from the cell's tip (y = 0) leftwards. All integrands are polynomials of sines of t, so
// 30 Gauss nodes are exact to rounding, also at the cusp (rho -> 1/2). The plain differences cost
// digits in proportion to 1/delta: about twenty of the 34 remain at delta = 1e-13, fifteen at
// 1e-19.
#pragma once

#include "tests/oracle/gauss_legendre.h"
#include "tools/flows/printed_formulas.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston::oracle {

inline PrintedMeasures<Quad> MeasuresByQuadrature(double rho_in, double delta_in) {
  const Quad rho = rho_in;
  const Quad delta = delta_in;
  const Quad half = Quad{1} / 2;
  const Quad lambda = sqrt(4 * rho * rho - 1);
  const auto angle_at = [&](Quad depth) { return asin((lambda / 2 + depth) / rho); };
  const Quad tip = angle_at(0);
  const Quad piston = angle_at(delta);
  const Quad middle = angle_at((1 - lambda) / 2);
  const auto depth = [&](Quad t) { return rho * sin(t) - lambda / 2; };
  const auto height = [&](Quad t) { return half - rho * cos(t); };
  const auto width = [&](Quad t) { return rho * cos(t); };  // d depth/dt

  PrintedMeasures<Quad> m;
  m.lambda = lambda;
  m.eta = 2 * height(piston);
  m.cell_area = 4 * Integrate([&](Quad t) { return height(t) * width(t); }, tip, middle);
  const Quad behind = 2 * Integrate([&](Quad t) { return height(t) * width(t); }, tip, piston);
  // A piece of the cell at a given depth is out of the ball's reach while the piston is beyond it.
  const Quad hidden =
      2 * Integrate([&](Quad t) { return height(t) * (delta - depth(t)) * width(t); }, tip, piston);
  m.volume = (lambda + 2 * delta) * m.cell_area - hidden;
  m.area_ball_piston = sqrt(Quad{2}) * behind;
  m.area_piston_wall = 2 * m.cell_area - behind;
  // Four arcs all the time, less two pieces of arc behind the piston.
  const Quad hidden_arcs =
      2 * rho * Integrate([&](Quad t) { return (t - tip) * width(t); }, tip, piston);
  m.area_ball_wall = (lambda + 2 * delta) * 4 * rho * (middle - tip) - hidden_arcs;
  return m;
}

}  // namespace ballpiston::oracle
