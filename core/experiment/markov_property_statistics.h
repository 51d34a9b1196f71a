// Statistics that test whether a sequence of energy exchanges is the limit's Markov jump process.
// They apply to orbits of any model.
//
// In the limit an exchange is e_k -> (waiting time tau_k, energy e_{k+1}), e the piston's energy,
// and with the exact laws of both (eqs. cnuep, kernel)
//   T_k = 1 - exp(-r(e_k) tau_k)      r the collision rate
//   V_k = F(e_{k+1} | e_k)            F the kernel's distribution function
// are uniform on [0, 1], and independent of each other, of e_k and of all earlier exchanges. By
// detailed balance the backward B_k = F(e_{k-1} | e_k) is also uniform. B_k and V_k are independent
// if e_{k+1} does not depend on e_{k-1} at given e_k. Measured:
//   hitting_time_ks_distance       of T_k to the uniform law
//   transition_divergence          of V_k to the uniform law, given a cell of e_k. The law of V_k
//                                  is exact at every delta, because the invariant law at fixed
//                                  energies is its own ingoing law. So this is a test of the engine
//   memory_divergence              of (B_k, V_k) to the uniform law of the square
//   memory_correlation             of B_k and V_k
//   waiting_outcome_correlation    of T_k and V_k
//   waiting_memory_correlation     of T_{k-1} and T_k
// A correlation is 12 <(x - 1/2)(y - 1/2)>; its error is from the scatter between orbits. The
// exchanges of an orbit of the billiard are correlated: a ball and a piston in a tip meet several
// times. So errors and noise floors of the distances are from the scatter between groups of orbits
// (statistics/group_scatter.h); errors of independent exchanges were 1.6 times too small at rho =
// 0.705, delta = 0.0026. Nothing has an error with fewer than kEventsForAnError orbits.
//
// In a BlockResult, histograms are first that of T; then for each of kGroups groups of orbits T in
// fewer bins, kEnergyRows rows of V by u = sqrt(2 e), and kMemoryBins rows of V by B. Batch means
// of the correlations have one batch an orbit. Units: times in |G|/|dG_bp|, total energy 1/2.
// Properties, each with a test of its name:
//   1. JumpProcessHasNoMemory: for a sample of the jump process every estimate is noise.
//   2. ErrorsHoldForCorrelatedExchanges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/ensemble/block_result.h"
#include "core/ensemble/measurement.h"

namespace ballpiston {

// Large enough that an orbit's first exchange, which has no exchange before it, costs little; small
// enough that there are enough orbits to fill the lanes.
inline constexpr uint64_t kExchangesPerOrbit = 32;

inline constexpr size_t kWaitingBins = 1024;
inline constexpr size_t kEnergyRows = 16;
inline constexpr size_t kOutcomeBins = 32;  // of V, in the rows by energy
inline constexpr size_t kMemoryBins = 16;

struct Exchange {
  double waiting_time = 0;
  double energy = 0;  // of the piston, after the collision; in [0, 1/2]
};

BlockResult EmptyMarkovPropertyCounts();

// Orbit `number`: the piston's energy at its start, just after a collision, and its exchanges in
// order.
void CountOrbit(uint64_t number, double energy, std::span<const Exchange> exchanges,
                BlockResult& counts);

// `is_limit`: the orbits are those of the jump process, whose correlation is 0. Distances are
// omitted if the counts are empty.
std::vector<Measurement> MarkovPropertyTable(bool is_limit);

}  // namespace ballpiston
