// The outline of the ball's cell near its right tip, as a function of the depth t = tip - x.
//
// With rho^2 = (1 + lambda^2)/4 the arcs above and below are at |y| = t (t + lambda)/(1/2 + s),
// where s = sqrt(rho^2 - (lambda/2 + t)^2) is the height of the discs' centres above their arcs.
// Accurate to a few ulps for 0 <= t <= (1 - lambda)/2. If rounding makes t larger, s is 0.
#pragma once

namespace ballpiston {

// s
double CentreToArc(double lambda, double depth);

// Half the height of the cell. At t = delta it is half the piston's height, eta/2.
double HalfHeight(double lambda, double depth);

}  // namespace ballpiston
