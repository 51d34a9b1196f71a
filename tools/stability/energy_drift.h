// The error of the energy after a long run, and its drift.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ballpiston::stability {

// Whether a value is more than four of its standard errors and more than an ulp, or one of the two
// is not a number.
bool IsTrend(double value, double standard_error);

// dE/E along a run, in twenty stretches of it.
class EnergyRecord {
 public:
  void Add(double share_of_run, double error);

  double Worst() const { return worst_; }  // infinite if an error is not a number

  // A straight line through the means of the stretches, by least squares.
  struct Line {
    double drift;  // its change over the run
    double error;  // one standard error of the drift
  };
  Line Fit() const;

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

struct EnergyRun {
  std::string method;
  std::string what;  // the moving bodies and the measured quantity
  uint64_t hits;     // wall hits of all orbits together
  uint64_t orbits;
  bool promised;  // the method promises |dE/E| <= 1e-14 without a trend
  EnergyRecord record;
};

// Whether the drift is a trend. Its standard error comes from the scatter of twenty stretches about
// a line: Student's t with 18 degrees of freedom, 8e-4 false alarms per run.
bool Drifts(const EnergyRun& run);
bool LosesEnergy(const EnergyRun& run);

std::vector<EnergyRun> EnergyRuns(double effort);
std::string EnergyTable(const std::vector<EnergyRun>& runs);

}  // namespace ballpiston::stability
