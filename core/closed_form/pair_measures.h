// Volume and surface areas of the pair's configuration space. All equilibrium rates follow from
// them.
//
//   |G|      volume of all (ball, piston) positions                       eq. Gv
//   |dG_bp|  area of the ball-piston collision surface                    eq. dGc
//   |dG_bw|  area of the ball-wall collision surface                      eq. dGb
//   |dG_pw|  area of the piston-wall collision surface                    eq. dGpw
//   cell     area of the ball's cell                                      eq. areax1x2
//   eta      height of the piston, the cell's width at its leftmost place
//
// The printed formulas subtract numbers of order one to get areas as small as lambda delta^2. The
// functions here are the same formulas in a form without cancellation, derived in pair_measures.cc.
//
// Units: cells (so cells^2 for areas, cells^3 for the volume). Domain: every PairGeometry. For
// delta below 1e-140 areas approach the smallest doubles, and the error bound may not hold.
//
// Properties, each with the test that bears its name:
//   1. AccurateForEveryGeometry: relative error below kPairMeasuresRelativeError.
//   2. RareLimitRateIsTheLimitOfTheRate: |dG_bp| = sqrt(2) lambda delta^2 as delta -> 0.
// |dG_bp|/sqrt(2) is half of the cell at delta = (1 - lambda)/2; |dG_pw| + |dG_bp|/sqrt(2) is twice
// the cell; d|G|/d delta = |dG_pw|.
//
// Pure functions: safe from any thread.
#pragma once

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

// The mean length of a ball's flight between walls: pi area/perimeter of its cell, averaged over
// the piston's positions.
double MeanFlight(const PairGeometry& geometry);

// Area of the ball's cell, eq. areax1x2. Domain: kMinRho < rho < kMaxRho.
double CellArea(double rho);

// The part of |Gamma| that can be reached at the two ends of the energy axis, where the piston or
// the ball rests. The ball meets a resting piston only if the piston is left of the cell's tip. The
// piston meets a resting ball only if the ball is within the piston's reach. Both volumes are less
// than |Gamma|.
struct RestingVolumes {
  double piston;  // epsilon = 0
  double ball;    // epsilon = 1/2
};

RestingVolumes VolumesAtRest(const PairGeometry& geometry);

}  // namespace ballpiston
