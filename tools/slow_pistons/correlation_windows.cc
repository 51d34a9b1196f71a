#include "tools/slow_pistons/correlation_windows.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "core/arithmetic/gauss_nodes.h"
#include "core/billiard/orbits.h"
#include "core/closed_form/kernel.h"
#include "core/closed_form/mean_free_time.h"
#include "core/markov/relaxation_spectrum.h"
#include "core/sampling/invariant_measure.h"
#include "core/statistics/step_function.h"
#include "tools/flows/numbered_orbits.h"

namespace ballpiston::slow_pistons {
namespace {

constexpr double kOrigins = kWindows.back();  // mean free times
// Orbits whose measurements wait to be merged in the order of their numbers.
constexpr uint64_t kOrbitsOfABlock = 16384;
constexpr double kJumpUnits = 4;  // |G|/|dG_bp| of a mean free time

struct OrbitIntegrals {
  std::array<double, kWindows.size()> all = {};
  std::array<double, kWindows.size()> idle = {};

  double Met(size_t i) const { return all[i] - idle[i]; }
};

// The piston's energy along an orbit, in mean free times.
class EnergyPath {
 public:
  explicit EnergyPath(double energy) : path_(energy), energy_(energy) {}

  void Add(double duration, double energy) {
    const double begin = end();
    path_.Add(duration, energy);
    if (begin < kOrigins) AddIdle(end() - begin, std::max(end() - kOrigins, 0.0));
    energy_ = energy;
  }
  double end() const { return path_.last_jump(); }

  OrbitIntegrals Integrals() const {
    OrbitIntegrals integrals;
    for (size_t i = 0; i < kWindows.size(); ++i) {
      integrals.all[i] = path_.CorrelationIntegral(kMeanPistonEnergy, kOrigins, kWindows[i]) /
                         kVarianceOfPistonEnergy;
      integrals.idle[i] = idle_[i] / kOrigins / kVarianceOfPistonEnergy;
    }
    return integrals;
  }

 private:
  // Adds a piece. A time origin in it counts the rest of the piece, or the window if that is
  // shorter.
  void AddIdle(double longest_rest, double shortest_rest) {
    for (size_t i = 0; i < kWindows.size(); ++i) {
      idle_[i] +=
          std::pow(energy_ - kMeanPistonEnergy, 2) *
          (IntegralOfRest(longest_rest, kWindows[i]) - IntegralOfRest(shortest_rest, kWindows[i]));
    }
  }

  // int_0^rest min(x, window) dx.
  static double IntegralOfRest(double rest, double window) {
    const double below = std::min(rest, window);
    return below * below / 2 + window * (rest - below);
  }

  StepFunction path_;
  double energy_;  // after the last jump
  std::array<double, kWindows.size()> idle_ = {};
};

class WindowedOrbits : public NumberedOrbits {
 public:
  WindowedOrbits(const PairGeometry& geometry, uint64_t seed, uint64_t first, uint64_t count)
      : geometry_(geometry),
        seed_(seed),
        first_(first),
        mean_free_time_(MeanFreeTimesOf(geometry).ball_piston),
        paths_(count),
        integrals_(count) {}

  PairState Start(uint64_t orbit) override {
    CounterRandom random(seed_, 0, first_ + orbit);
    const PairState state = DrawFromFlowMeasure(geometry_, random);
    paths_[orbit].emplace(state.piston_velocity * state.piston_velocity / 2);
    return state;
  }

  // An orbit ends with its first collision after the last window. A piston that has not collided by
  // then has its energy for all windows.
  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    std::optional<EnergyPath>& path = paths_[orbit];
    if (!collision.expired && !collision.escaped) {
      // After the collision the piston has the ball's normal velocity component.
      const double v = collision.state.ball_speed * collision.state.direction.x();
      path->Add(collision.time / mean_free_time_, v * v / 2);
      if (path->end() < kOrigins + kWindows.back()) return AfterCollision::kGoOn;
    } else {
      path->Add(TimeLimit() / mean_free_time_, 0);
    }
    integrals_[orbit] = path->Integrals();
    path.reset();
    return AfterCollision::kEnd;
  }

  double TimeLimit() const override { return (kOrigins + kWindows.back()) * mean_free_time_; }

  const std::vector<OrbitIntegrals>& integrals() const { return integrals_; }

 private:
  const PairGeometry& geometry_;
  uint64_t seed_;
  uint64_t first_;
  double mean_free_time_;
  std::vector<std::optional<EnergyPath>> paths_;  // of the orbits that run
  std::vector<OrbitIntegrals> integrals_;
};

}  // namespace

double LimitOfAll(double window) {
  return RelaxationSpectrum::Get().CorrelationTime(kJumpUnits * window).value / kJumpUnits;
}

// The rate has a root at u = 1/sqrt 2.
double LimitOfIdle(double window) {
  double sum = 0;
  const auto add = [&](double u, double weight) {
    const double rate = kJumpUnits * PairCollisionRate(u * u / 2);
    sum += weight * std::pow(u * u / 2 - kMeanPistonEnergy, 2) * -std::expm1(-rate * window) / rate;
  };
  ForEachGaussNodeWithRoot<30>(0, std::numbers::sqrt2 / 2, add);
  ForEachGaussNode<30>(std::numbers::sqrt2 / 2, 1, add);
  return sum / kVarianceOfPistonEnergy;
}

std::array<WindowIntegrals, kWindows.size()> CorrelationWindows(const PairGeometry& geometry,
                                                                uint64_t orbits, uint64_t seed) {
  std::array<WindowIntegrals, kWindows.size()> windows;
  for (size_t i = 0; i < kWindows.size(); ++i) {
    windows[i].limit_all = LimitOfAll(kWindows[i]);
    windows[i].limit_idle = LimitOfIdle(kWindows[i]);
  }
  for (uint64_t first = 0; first < orbits; first += kOrbitsOfABlock) {
    const uint64_t count = std::min(kOrbitsOfABlock, orbits - first);
    WindowedOrbits block(geometry, seed, first, count);
    block.Run(Engine::kLanes, geometry, count);
    for (const OrbitIntegrals& orbit : block.integrals()) {
      for (size_t i = 0; i < kWindows.size(); ++i) {
        windows[i].all.Add(orbit.all[i]);
        windows[i].idle.Add(orbit.idle[i]);
        windows[i].met.Add(orbit.Met(i));
        windows[i].later_idle.Add(orbit.idle[i] - orbit.idle[0]);
        windows[i].later_met.Add(orbit.Met(i) - orbit.Met(0));
        if (i > 0 && orbit.idle[i] != orbit.idle[i - 1]) ++windows[i].later_idles;
      }
    }
  }
  return windows;
}

}  // namespace ballpiston::slow_pistons
