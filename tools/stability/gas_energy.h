// The error of the energy of gases after long runs.
//
// Each exchange rounds the energies of two bodies. Therefore the energy of a gas makes a random
// walk, and a straight line through a random walk means nothing. Instead many gases run, and a
// trend is a mean over the gases.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/statistics/moments.h"

namespace ballpiston::stability {

struct GasEnergyRun {
  std::string method;
  bool promised;           // the method promises to lose no energy
  uint64_t exchanges = 0;  // of all gases
  Moments errors = {};     // signed dE/E at the end of each gas
  double worst = 0;        // infinite if an error is not a number

  void Add(double error);
};

// Whether the mean is a trend (energy_drift.h). Its standard error comes from 48 gases: Student's t
// with 47 degrees of freedom, 2e-4 false alarms per run.
bool HasTrend(const GasEnergyRun& run);
// The limit of the worst error, in ulps times the square root of the number of exchanges of one
// gas.
inline constexpr double kUlpsOfAWalk = 4;
bool LosesEnergy(const GasEnergyRun& run);

std::vector<GasEnergyRun> GasEnergyRuns(double effort);
std::string GasEnergyTable(const std::vector<GasEnergyRun>& runs);

}  // namespace ballpiston::stability
