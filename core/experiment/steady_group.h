// A group of trajectories of a gas in a steady state: where they are, and what has been measured.
//
// A chunk takes the group from its GroupState, and leaves it in another one (chunk_plan.h). The
// trajectories of a group have the same number of stretches. The charge is the energy that has
// passed along x, the mean over all sections between a ball and a piston. Windows of the charge
// have 1, 2, 4, ... stretches; those of one length follow each other without gaps.
//
// The warm-up is judged by the energies that have entered and left since the group's start: their
// difference is the change of the gas's energy. See SteadyGas.
//
// Property, with the test that bears its name: 1. WindowsHoldTheWholeCharge.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/ensemble/block_result.h"
#include "core/gas/gas_state.h"
#include "core/statistics/moments.h"

namespace ballpiston {

inline constexpr size_t kWindowLengths = 20;

struct SteadyTrajectory {
  GasState state = {};
  double energy = 0;                               // when the warm-up was judged last
  std::vector<double> sums = {};                   // integrals over the measured time, by quantity
  std::array<double, kWindowLengths> halves = {};  // the charge of the first half of a window
};

struct SteadyGroup {
  double stretches = 0;                              // of each trajectory, since its start
  double measured = 0;                               // of them
  std::array<Moments, kWindowLengths> windows = {};  // of the charge; window i has 2^i stretches
  std::vector<SteadyTrajectory> trajectories = {};

  // Adds the charges of the next stretch, by trajectory.
  void AddStretch(const std::vector<double>& charges);
};

// The sizes of a group. The jump process has speeds, but no positions.
struct SteadyShape {
  size_t trajectories = 0;
  size_t quantities = 0;
  size_t balls = 0;
  size_t pistons = 0;
  bool has_positions = true;

  SteadyGroup NewGroup() const;
  size_t Numbers() const;
  GroupState Written(SteadyGroup group) const;
  // Requires a state of Numbers() numbers.
  SteadyGroup Read(const GroupState& state) const;
};

}  // namespace ballpiston
