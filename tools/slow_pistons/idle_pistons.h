// How long the pistons of a chain between two reservoirs exchange no energy.
//
// A piston is idle from an exchange, with a ball or with a thermal wall, to its next one. Of the
// piston k, P_k(s) is the probability that it exchanges nothing during a time s that begins at any
// time of the steady state. Slow pistons make s P_k(s) tend to a constant a_k.
//
// An outermost piston crosses the length L' = lambda + delta between its wall and the ball's cell.
// It leaves the wall at the rate r with the density v exp(-v^2/(2 T))/T, and arrives there with
// speeds below v at the rate F(v), which is of order v^2. A flight at the speed v is longer than s
// if v < L'/s. Therefore
//
//   a_k = r L'^2/(2 T) + lim s^2 F(L'/s)
//
// The second term converges faster than s P_k(s): it does not count the time in which a slow piston
// is within the ball's reach before they meet. In equilibrium a_k = L'^2/(L sqrt(2 pi T)), with the
// stroke L = lambda + 2 delta.
//
// Units: lengths are cells, masses 1. Properties, each with the test that bears its name:
//   1. OutermostPistonsInEquilibriumHaveTheirLimit.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/gas/gas_geometry.h"
#include "core/statistics/moments.h"

namespace ballpiston::slow_pistons {

inline constexpr std::array<double, 9> kIdleTimes = {4, 8, 16, 32, 64, 128, 256, 512, 1024};

// The measurements of one piston at one time s. A sample of the moments is a block of time. Each
// mean is determined by the events that are counted beside it; if these are few, the scatter of the
// blocks is not the error of the mean.
struct IdleShare {
  Moments share = {};        // s P(s)
  Moments limit = {};        // r L'^2/(2 T) + s^2 F(L'/s); of an outermost piston
  double long_idles = 0;     // events of `share`: the idle times longer than s
  double slow_arrivals = 0;  // events of `limit`: the arrivals slower than L'/s
};
using IdleShares = std::array<IdleShare, kIdleTimes.size()>;

struct SteadyChain {
  double hot = 1;
  double cold = 1;
  double block = 0;     // the length of a block of time
  uint64_t blocks = 0;  // without the first one, which is the warm-up
  uint64_t seed = 0;
};

// By piston, from the hot one to the cold one. The geometry is a chain with reservoirs.
std::vector<IdleShares> IdlePistons(const GasGeometry& geometry, const SteadyChain& chain);

}  // namespace ballpiston::slow_pistons
