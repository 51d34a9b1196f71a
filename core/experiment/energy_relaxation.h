// Relaxation of the piston's energy, in the billiard or in the jump process of its limit.
//
// Without epsilon: the autocorrelation C(t) = <ep(0) ep(t)> - 1/36 in equilibrium, from orbits that
// start from the flow's invariant measure. Time origins extend over kOriginTimes mean free times,
// lags over kWindowTimes. relaxation_time is the integral time int_0^W C dt/C(0) over the window W,
// plus the part beyond W from the limit's spectrum (0.03 %). The exact values C(0) = 1/45 and
// mean 1/6, valid at every delta, are used.
//
// With epsilon: E[ep(t)] from this initial energy, with uniform positions of ball and piston.
// decay_integral is int_0^W (E[ep(t)] - 1/6) dt plus the part beyond W from the limit.
// relaxation_time is decay_integral/(epsilon - 1/6). It is given only outside of kNoDecayFrom ...
// kNoDecayTo: around 1/6 the mean energy first moves away from 1/6, and the ratio has a zero (at
// 0.141) and a pole.
//
// The result depends on the window. A piston of speed u is out of the ball's reach for a time of up
// to 2 lambda/u, at every delta. So in the billiard slow pistons give C a tail of order lambda/t,
// whose integral grows with the logarithm of W. The tail vanishes in the limit: at a fixed W/tau it
// is of order lambda/tau, that is delta^2.
//
// EnergyRelaxation has the scales that all models share, the measurements of an orbit, and the
// estimates. The numbers of an orbit, of which there are moments, are the integral and then the
// curve at kLags times. With epsilon there are also histograms of the piston's energy at each of
// kLawLags: the law P(ep, t) of eq. meq, compared with that of the limit (energy_law.h). A sample
// is one orbit.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/ensemble/measurement.h"
#include "core/ensemble/model.h"
#include "core/ensemble/parameter.h"
#include "core/geometry/pair_geometry.h"
#include "core/markov/relaxation_spectrum.h"
#include "core/statistics/step_function.h"

namespace ballpiston {

// In mean free times of ball and piston.
inline constexpr double kWindowTimes = 8;
inline constexpr double kOriginTimes = 32;

// Initial energies between these have no relaxation time.
inline constexpr double kNoDecayFrom = 0.12;
inline constexpr double kNoDecayTo = 0.2;

inline constexpr size_t kLags = 33;  // equally spaced, from 0 to the window

// The law of the energy is measured at 1/4, 1/2, 1, 2, 4 and 8 mean free times.
inline constexpr std::array<size_t, 6> kLawLags = {1, 2, 4, 8, 16, 32};
// Bins over [0, 1/2]. A prime number, so that no short decimal number inside is an edge of a bin.
// At an edge, rounding would decide the bin of an orbit that has not changed its energy.
inline constexpr size_t kEnergyBins = 61;

class EnergyRelaxation {
 public:
  EnergyRelaxation(const PairGeometry& geometry, const PointParameters& point,
                   Model model = Model::kBilliard);

  const std::optional<double>& epsilon() const { return epsilon_; }
  double unit() const { return unit_; }
  double orbit_time() const;  // duration of an orbit

  // A result without orbits.
  BlockResult Empty() const;

  // The numbers of one orbit.
  std::vector<double> Measure(const StepFunction& energy) const;
  // Adds the numbers of one orbit.
  void Record(const std::vector<double>& values, BlockResult& result) const;

  // The events of an orbit for the standard errors (statistics/stated_error.h). Each walk of the
  // jump process counts. In the billiard, from an epsilon: about the share of orbits in which ball
  // and piston meet. The piston's energy is constant in the others, so the scatter is that of the
  // orbits that meet.
  double events_per_orbit() const { return events_per_orbit_; }

  // relaxation_time, if it exists; with epsilon also decay_integral. The jump process is the limit,
  // whose value is exact for it; the spectrum knows both. The table must not outlive this object.
  std::vector<Measurement> Table() const;
  Curve MeasuredCurve(const BlockResult& merged) const;
  std::vector<NamedHistogram> MeasuredLaws(const BlockResult& merged) const;

  // These four are for the limit. Their errors are bounds of the numerical error. The integral is
  // that of the autocorrelation, or of the mean energy less 1/6.
  BoundedValue IntegralOfLimit() const;
  Curve CurveOfLimit() const;
  std::vector<NamedHistogram> LawsOfLimit() const;  // their bins, without counts
  std::vector<std::vector<double>> ProbabilitiesOfLimit() const;

 private:
  using ByLag = Eigen::Array<double, kLags, 1>;

  ByLag Autocorrelation(const StepFunction& energy) const;
  double window() const { return kWindowTimes * mean_free_time_; }
  double Lag(size_t i) const { return window() / (kLags - 1) * static_cast<double>(i); }
  BoundedValue IntegralOfLimit(double window) const;  // up to `window`
  std::optional<Estimate> MeasuredIntegral(const BlockResult& merged) const;

  Model model_;
  std::optional<double> epsilon_;
  double unit_of_limit_;  // |G|/|dG_bp|: the spectrum's unit of time
  double unit_;           // unit_of_limit_ without its last bits; measurements use it
  double mean_free_time_;
  double events_per_orbit_;
  // From an epsilon: the mean time between collisions at this energy. By a time t at most the share
  // t/return_time_ of the orbits has met.
  double return_time_;
};

// Whether relaxation_time exists: in equilibrium, and from energies far enough from 1/6.
bool HasRelaxationTime(const std::optional<double>& epsilon);

// Says why relaxation_time is missing; empty if it exists.
std::vector<std::string> RemarksOnDecay(const std::optional<double>& epsilon);

// Mean number of ball-piston collisions in an orbit.
double CollisionsPerOrbit(const PointParameters& point);

}  // namespace ballpiston
