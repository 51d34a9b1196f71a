// What is left of the energy after a long run, and whether it drifts.
#ifndef BALLPISTON_TOOLS_STABILITY_ENERGY_DRIFT_H_
#define BALLPISTON_TOOLS_STABILITY_ENERGY_DRIFT_H_

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
  // What a straight line through the stretches' means gains over the run, and its standard error.
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
  std::string what;  // is flown and measured
  uint64_t hits;     // of the ball on walls, one orbit or all together
  uint64_t orbits;
  bool promised;  // to keep |dE/E| <= 1e-14 without a trend
  EnergyRecord record;
};

// A drift is one if it is more than four of its standard errors and more than an ulp, or not a
// number. The standard error is that of twenty stretches about a line: Student's t with 18 degrees
// of freedom, 8e-4 false alarms a run.
bool Drifts(const EnergyRun& run);

std::vector<EnergyRun> EnergyRuns(double effort);

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_ENERGY_DRIFT_H_
