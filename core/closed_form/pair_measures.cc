// Derivation. Measure depth t leftwards from the cell's right tip and height y upwards from its
// axis. The upper right disc has its centre at t = -lambda/2, y = 1/2; its arc leaves the tip
// (0, 0), rises to y(t), and bounds the cell from above.
//
// Height. With a = lambda/2 + t the arc is at y = 1/2 - s, s = sqrt(rho^2 - a^2). From
// rho^2 = (1 + lambda^2)/4 follows 1/4 - s^2 = t (t + lambda), hence
//     y(t) = t (t + lambda)/(1/2 + s) .
//
// Area. The chord from (0, 0) to (t, y) has length c = hypot(t, y) and subtends D at the disc's
// centre. The area between axis and arc is the triangle t y/2 minus the segment S between arc and
// chord. For both halves of the cell:
//     P(t) = t y - 2 S .
// S is at most half of the triangle (at lambda = 0, where y = t^2), so there is no cancellation.
// P(delta) is the projection of the collision surface, which is tilted by 45 degrees:
// |dG_bp| = sqrt(2) P. At t = b = (1 - lambda)/2 the arc ends at the cell's upper tip, so y = b by
// symmetry, and P(b) is half of the cell: cell = 2 P(b).
//
// Volume. For each of the piston's positions, the cell minus the part behind the piston:
//     |G| = (lambda + 2 delta) cell - Q,   Q = int_0^delta P(t) dt .
// Exchanging the integrals, Q is the moment of that region about the piston's leftmost position,
// 2 int y(t) (delta - t) dt. The triangle (area delta y/2, centroid 2 delta/3) gives
// delta^2 y/3. The segment's centroid lies at c^3/(12 S) from the disc's centre in the direction of
// the middle of the arc; with m the sine of that direction's angle to the y axis the segment gives
// 2 (a S - m c^3/12):
//     Q = delta^2 y/3 - 2 a S + m c^3/6,   m = (a + lambda/2)/(2 rho cos(D/2)) .
//
// Ball-wall area. A position of the piston at depth t hides an arc of angle D(t) on each of two
// discs, and 4 rho D(b) is the cell's perimeter. By parts, int D dt = t D - int t dD; as the arc's
// angle to the vertical grows by dD, t + lambda/2 = rho sin and 1/2 - y = rho cos of this angle, so
// int t dD = y - lambda D/2. The remaining part of (lambda + 2 delta) 4 rho D(b) is
//     |dG_bw| = rho [ (lambda + 2 delta)(4 D(b) - D) + 2 y ] .
//
// Piston-wall area. The whole cell at the right end, and the cell minus P at the left end:
// |dG_pw| = 2 cell - P.
#include "core/closed_form/pair_measures.h"

#include <cmath>
#include <numbers>

#include "core/closed_form/circular_segment.h"

namespace ballpiston {
namespace {

// The part of the upper right disc's arc between the cell's tip and a given depth.
struct TipArc {
  double height;   // y
  double chord;    // c
  double angle;    // D
  double segment;  // S
};

TipArc ArcTo(double rho, double depth, double height) {
  const double chord = std::hypot(depth, height);
  const double angle = 2 * std::asin(chord / (2 * rho));
  return {height, chord, angle, rho * rho / 2 * AngleMinusSine(angle)};
}

// P: area of the cell right of the given depth.
double AreaBehind(const TipArc& arc, double depth) { return depth * arc.height - 2 * arc.segment; }

TipArc QuarterArc(double rho, double bound) { return ArcTo(rho, bound, bound); }

TipArc ReachableArc(const PairGeometry& g) {
  return ArcTo(g.rho(), g.delta(), g.HalfHeight(g.delta()));
}

// Q: integral of AreaBehind from 0 to delta.
double HiddenVolume(const PairGeometry& g, const TipArc& arc) {
  const double a = g.lambda() / 2 + g.delta();
  const double m = (g.lambda() + g.delta()) / (2 * g.rho() * std::cos(arc.angle / 2));
  return g.delta() * g.delta() * arc.height / 3 - 2 * a * arc.segment +
         m * arc.chord * arc.chord * arc.chord / 6;
}

}  // namespace

double CellArea(double rho) {
  const double bound = PairDeltaBound(rho);
  return 2 * AreaBehind(QuarterArc(rho, bound), bound);
}

PairMeasures Measures(const PairGeometry& g) {
  const TipArc arc = ReachableArc(g);
  const TipArc quarter = QuarterArc(g.rho(), g.tip());
  const double stroke = g.stroke();
  const double behind = AreaBehind(arc, g.delta());
  const double cell = 2 * AreaBehind(quarter, g.tip());
  return {
      .eta = 2 * arc.height,
      .cell_area = cell,
      .volume = stroke * cell - HiddenVolume(g, arc),
      .area_ball_piston = std::numbers::sqrt2 * behind,
      .area_ball_wall = g.rho() * (stroke * (4 * quarter.angle - arc.angle) + 2 * arc.height),
      .area_piston_wall = 2 * cell - behind,
  };
}

double MeanFlight(const PairGeometry& g) {
  const PairMeasures measures = Measures(g);
  return std::numbers::pi * measures.cell_area * g.stroke() / measures.area_ball_wall;
}

RestingVolumes VolumesAtRest(const PairGeometry& g) {
  const TipArc arc = ReachableArc(g);
  const double hidden = HiddenVolume(g, arc);
  const double stroke = g.stroke();
  return {.piston = g.delta() * CellArea(g.rho()) - hidden,
          .ball = stroke * AreaBehind(arc, g.delta()) - hidden};
}

}  // namespace ballpiston
