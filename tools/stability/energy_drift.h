// The error of the energy after a long run, and its drift.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace ballpiston::stability {

// dE/E along a run, in twenty stretches of it.
class EnergyRecord {
 public:
  void Add(double share_of_run, double error);

  double Worst() const { return worst_; }  // infinite if an error is not a number
  // The change over the run of a straight line through the means of the stretches, and its standard
  // error.
  double Drift() const;
  double DriftError() const;

 private:
  static constexpr size_t kStretches = 20;
  struct Stretch {
    uint64_t count = 0;
    double sum = 0;
  };

  double Mean(size_t stretch) const;
  double MeanOfMeans() const;

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

// A drift counts as a trend if it is more than four of its standard errors and more than an ulp, or
// not a number. The standard error comes from the scatter of twenty stretches about a line:
// Student's t with 18 degrees of freedom, 8e-4 false alarms per run.
bool Drifts(const EnergyRun& run);

std::vector<EnergyRun> EnergyRuns(double effort);

}  // namespace ballpiston::stability
