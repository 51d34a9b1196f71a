// What is left of the energy of gases after long runs.
//
// Each exchange rounds the energy of its two bodies, so the energy of a gas makes a random walk. A
// straight line through a random walk means nothing: so there are many gases, and a trend is a mean
// over gases.
#ifndef BALLPISTON_TOOLS_STABILITY_GAS_ENERGY_H_
#define BALLPISTON_TOOLS_STABILITY_GAS_ENERGY_H_

#include <cstdint>
#include <string>
#include <vector>

#include "core/statistics/moments.h"

namespace ballpiston::stability {

struct GasEnergyRun {
  std::string method;
  bool promised;           // to lose no energy
  uint64_t exchanges = 0;  // of all gases
  Moments errors = {};     // signed dE/E at the end, a gas each
  double worst = 0;        // infinite if one is not a number

  void Add(double error);
};

// A mean of more than four of its standard errors and an ulp, or one that is not a number. The
// standard error is that of 48 gases: Student's t with 47 degrees of freedom, 2e-4 false alarms a
// run.
bool HasTrend(const GasEnergyRun& run);
// Errors of more than this many ulps for the root of a gas's exchanges.
inline constexpr double kUlpsOfAWalk = 4;
bool LosesEnergy(const GasEnergyRun& run);

std::vector<GasEnergyRun> GasEnergyRuns(double effort);

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_GAS_ENERGY_H_
