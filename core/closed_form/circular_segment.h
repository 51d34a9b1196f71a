// The circular segment: the part of a disc that a chord cuts off.
//
//   segment = r^2 (theta - sin theta)/2,   theta = 2 arcsin(chord/(2 r))
//
// The printed closed forms contain this difference as a trapezium minus a sector, which loses all
// digits on short arcs. The functions here compute the difference directly.
//
// Domain: 0 <= angle <= 2 pi; 0 <= chord <= 2 radius, radius > 0.
//
// Properties, each with the test that bears its name:
//   1. AngleMinusSineIsAccurate to kAngleMinusSineRelativeError, unless angle^3 underflows.
//   2. AngleMinusSineOfATinyAngleIsItsCube.
//
// Pure functions: safe from any thread.
#pragma once

namespace ballpiston {

inline constexpr double kAngleMinusSineRelativeError = 2e-15;

// angle - sin(angle).
double AngleMinusSine(double angle);

// Angle at the centre that a chord subtends, in [0, pi].
double ChordAngle(double radius, double chord);

// Area between the arc of that angle and its chord.
double SegmentArea(double radius, double angle);

}  // namespace ballpiston
