// The error of the energy after long runs.
//
// A pair, or a ball alone: the error along one run, and its drift. A gas: each exchange rounds the
// energies of two bodies. Therefore the energy of a gas makes a random walk, and a straight line
// through a random walk means nothing. Instead many gases run, and the mean of their errors at the
// end takes the place of the drift.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/statistics/moments.h"

namespace ballpiston::stability {

struct EnergyChange {
  double value;
  double error;  // one standard error

  // Whether the value is more than four of its standard errors and more than an ulp, or one of the
  // two is not a number.
  bool IsTrend() const;
};

// dE/E along a run, in twenty stretches of it.
class EnergyRecord {
 public:
  void Add(double share_of_run, double error);

  double Worst() const { return worst_; }  // infinite if an error is not a number
  // The drift over the run: a straight line through the means of the stretches, by least squares.
  // Its standard error comes from the scatter of twenty stretches about the line: Student's t with
  // 18 degrees of freedom, 8e-4 false trends per run.
  EnergyChange Drift() const;

 private:
  static constexpr size_t kStretches = 20;
  struct Stretch {
    uint64_t count = 0;
    double sum = 0;

    double Mean() const { return count == 0 ? 0 : sum / static_cast<double>(count); }
  };

  std::array<Stretch, kStretches> stretches_;
  double worst_ = 0;
};

// dE/E at the end of each of several gases.
class GasEnergyRecord {
 public:
  void Add(uint64_t exchanges, double error);

  uint64_t exchanges() const { return exchanges_; }  // of all gases
  double Worst() const { return worst_; }            // infinite if an error is not a number
  // Four ulps times the square root of the number of exchanges of one gas: a random walk.
  double LongestWalk() const;
  // The mean. Its standard error comes from 48 gases: Student's t with 47 degrees of freedom, 2e-4
  // false trends per run.
  EnergyChange Mean() const { return {errors_.mean, errors_.StandardError().value_or(0)}; }

 private:
  uint64_t exchanges_ = 0;
  Moments errors_;
  double worst_ = 0;
};

struct EnergyRun {
  std::string method;
  std::string what;     // the moving bodies and the measured quantity
  uint64_t orbits;      // or gases
  uint64_t hits;        // of all orbits together: on walls, in a gas on pistons
  bool promised;        // the method promises to lose no energy
  double worst;         // |dE/E|
  double permitted;     // for `worst`
  EnergyChange change;  // the drift, or the mean at the end

  bool LosesEnergy() const { return change.IsTrend() || !(worst <= permitted); }
};

std::vector<EnergyRun> EnergyRuns(double effort);

std::string EnergyTable(const std::vector<EnergyRun>& runs);

}  // namespace ballpiston::stability
