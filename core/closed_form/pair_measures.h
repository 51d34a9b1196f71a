// Volume and surface areas of the pair's configuration space: what every equilibrium rate is made
// of.
//
//   |G|      volume of all (ball, piston) positions                       eq. Gv
//   |dG_bp|  area of the ball-piston collision surface                    eq. dGc
//   |dG_bw|  area of the ball-wall collision surface                      eq. dGb
//   |dG_pw|  area of the piston-wall collision surface                    eq. dGpw
//   cell     area of the ball's cell                                      eq. areax1x2
//   eta      height of the piston, the cell's width at its leftmost place
//
// The printed formulas subtract numbers of order one to get areas down to lambda delta^2. These
// are the same functions in forms that do not cancel; the derivation opens pair_measures.cc.
//
// Units: cells (so cells^2 for areas, cells^3 for the volume). Domain: every PairGeometry; below
// delta = 1e-140 areas approach the smallest doubles and the error bound is not promised.
//
// Properties, each with the test that bears its name:
//   1. AccurateAtRandomGeometries, AccurateWhereTheCellVanishes (rho -> 1/sqrt(2)),
//      AccurateAtTheBound (of delta), AccurateAtTheSmallestRadius (rho -> 1/2): relative error
//      below kPairMeasuresRelativeError.
//   2. PistonAtTheBoundHalvesTheCell: |dG_bp|/sqrt(2) = cell/2 at delta = (1 - lambda)/2.
//   3. PistonWallAreaIsTheCellTwiceLessTheProjection: |dG_pw| + |dG_bp|/sqrt(2) = 2 cell.
//   4. VolumeGrowsByThePistonWallArea: d|G|/d delta = |dG_pw|.
//   5. RareCollisionsSeeAWedge: |dG_bp| = sqrt(2) lambda delta^2 as delta -> 0.
//
// Pure functions: safe from any thread.
#ifndef BALLPISTON_CORE_CLOSED_FORM_PAIR_MEASURES_H_
#define BALLPISTON_CORE_CLOSED_FORM_PAIR_MEASURES_H_

#include "core/geometry/pair_geometry.h"

namespace ballpiston {

inline constexpr double kPairMeasuresRelativeError = 4e-15;

struct PairMeasures {
  double eta;
  double cell_area;
  double volume;
  double area_ball_piston;
  double area_ball_wall;
  double area_piston_wall;
};

PairMeasures Measures(const PairGeometry& geometry);

// Area of the ball's cell, eq. areax1x2. Domain: kMinRho < rho < kMaxRho.
double CellArea(double rho);

// What of |Gamma| can be reached at the two ends of the energy axis, where one of the two rests:
// a resting piston is met only if it stands left of the cell's tip, a resting ball only if it lies
// where the piston comes by. Both are less than |Gamma|.
struct RestingVolumes {
  double piston;  // epsilon = 0
  double ball;    // epsilon = 1/2
};

RestingVolumes VolumesAtRest(const PairGeometry& geometry);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_CLOSED_FORM_PAIR_MEASURES_H_
