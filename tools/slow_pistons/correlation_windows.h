// The integral of the piston's energy correlation in equilibrium, by the length of its window, and
// the part of it that belongs to pairs that do not collide.
//
//   all(W)  = int_0^W <e(0) e(t)> dt/<e^2>,                    e = ep - 1/6, <e^2> = 1/45
//   idle(W) = int_0^W <e(0)^2 1{no collision in (0, t)}> dt/<e^2>
//
// all - idle is the part of pairs that have collided between the two times. Orbits start from the
// flow's invariant measure. Time origins extend over kWindows.back() mean free times.
//
// In the limit delta -> 0 `all` comes from the generator's spectrum, and
// idle(W) = 45 int_0^1 (u^2/2 - 1/6)^2 (1 - exp(-r(u) W))/r(u) du, with the rate r of jumps.
//
// All values are in mean free times of ball and piston. Properties, each with the test that bears
// its name: 1. WindowsAreThoseOfTheJumpProcess.  2. LimitOfAllIsTheIntegralTime.
//   3. LimitOfIdleIsThatOfTheMidpointRule.
#pragma once

#include <array>
#include <cstdint>

#include "core/geometry/pair_geometry.h"
#include "core/statistics/moments.h"

namespace ballpiston::slow_pistons {

inline constexpr std::array<double, 5> kWindows = {8, 16, 32, 64, 128};  // mean free times

struct WindowIntegrals {
  Moments all = {};
  Moments idle = {};
  Moments met = {};  // all - idle
  // The parts beyond the first window: idle(W) - idle(W_0), and so on.
  Moments later_idle = {};
  Moments later_met = {};
  double later_idles = 0;  // orbits with a longer idle time than the window before this one
  double limit_all = 0;
  double limit_idle = 0;
};

// By window, from `orbits` orbits.
std::array<WindowIntegrals, kWindows.size()> CorrelationWindows(const PairGeometry& geometry,
                                                                uint64_t orbits, uint64_t seed);

// The limits of a window.
double LimitOfAll(double window);
double LimitOfIdle(double window);

}  // namespace ballpiston::slow_pistons
