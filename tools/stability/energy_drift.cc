#include "tools/stability/energy_drift.h"

#include <algorithm>
#include <cmath>

#include "core/billiard/reference_flow.h"
#include "core/geometry/paper.h"
#include "core/sampling/invariant_measure.h"
#include "tools/flows/lane_balls.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/flows/precise_flow.h"
#include "tools/flows/rounded_to.h"
#include "tools/stability/error_size.h"
#include "tools/stability/event_methods.h"
#include "tools/stability/fixed_step_events.h"
#include "tools/stability/lane_methods.h"
#include "tools/stability/textbook_flow.h"
#include "tools/stability/wall_starts.h"

namespace ballpiston::stability {
namespace {

constexpr double kEnergyDelta = 0.1;
constexpr uint64_t kEnergySeed = 23;

PairGeometry Geometry() { return *PairGeometry::Create(kPaperRho, kEnergyDelta); }

PairState Start(uint64_t orbit) {
  CounterRandom random(kEnergySeed, 0, orbit);
  return DrawFromCollisionMeasure(Geometry(), random);
}

double Share(uint64_t part, uint64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

// One vector of balls alone. The error of their energy is |u|^2 - 1, checked every thousand
// flights.
EnergyRecord BallsInLanes(FlyLanes fly, uint64_t hits) {
  constexpr uint64_t kBetweenLooks = 1000;
  const PairGeometry geometry = Geometry();
  std::vector<LaneFrame> balls;
  for (uint64_t i = 0; i < 4; ++i) {
    CounterRandom random(kEnergySeed, 1, i);
    const PairState start = AnywhereOnWall(geometry, random);
    balls.push_back(FrameOfBallOnWall(start.position, start.direction));
  }
  std::vector<LaneHit> last(balls.size());
  EnergyRecord record;
  for (uint64_t done = 0; done < hits; done += kBetweenLooks) {
    fly(geometry, balls, kBetweenLooks, last);
    for (size_t i = 0; i < balls.size(); ++i) {
      balls[i] = last[i].frame;
      record.Add(Share(done, hits), SquaredLengthError(balls[i]));
    }
  }
  return record;
}

// Pairs in equilibrium, checked at every collision.
class PairsInEquilibrium : public NumberedOrbits {
 public:
  PairsInEquilibrium(uint64_t orbits, uint64_t hits_each)
      : hits_each_(hits_each), hits_(orbits, 0) {}

  PairState Start(uint64_t orbit) override { return stability::Start(orbit); }
  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    hits_[orbit] += collision.ball_wall_hits;
    record_.Add(std::min(Share(hits_[orbit], hits_each_), 1.0), SignedEnergyError(collision.state));
    const bool on = !collision.escaped && hits_[orbit] < hits_each_;
    return on ? AfterCollision::kGoOn : AfterCollision::kEnd;
  }

  const EnergyRecord& record() const { return record_; }

 private:
  uint64_t hits_each_;
  std::vector<uint64_t> hits_;
  EnergyRecord record_;
};

EnergyRecord PairsByEngine(Engine engine, uint64_t orbits, uint64_t hits_each) {
  PairsInEquilibrium pairs(orbits, hits_each);
  RunOrbits(engine, Geometry(), orbits, pairs);
  return pairs.record();
}

// One pair, event by event.
template <typename Flow>
EnergyRecord PairByEvents(uint64_t hits) {
  EnergyRecord record;
  Flow flow(Geometry(), RoundedTo<RealOf<Flow>>(Start(0)));
  for (uint64_t done = 0; done < hits;) {
    const EventKind kind = flow.Step().kind;
    if (kind == EventKind::kEscape) break;
    done += kind == EventKind::kBallWall;
    if (kind == EventKind::kBallPiston) flow.ExchangeComponents();
    if (kind == EventKind::kBallPiston)
      record.Add(Share(done, hits), SignedEnergyError(flow.state()));
  }
  return record;
}

}  // namespace

void EnergyRecord::Add(double share_of_run, double error) {
  const auto place = static_cast<size_t>(share_of_run * kStretches);
  Stretch& stretch = stretches_[std::min(place, kStretches - 1)];
  ++stretch.count;
  stretch.sum += error;
  worst_ = std::max(worst_, ErrorSize(error));
}

double EnergyRecord::Mean(size_t stretch) const {
  const Stretch& s = stretches_[stretch];
  return s.count == 0 ? 0 : s.sum / static_cast<double>(s.count);
}

double EnergyRecord::MeanOfMeans() const {
  double sum = 0;
  for (size_t i = 0; i < kStretches; ++i) sum += Mean(i);
  return sum / kStretches;
}

// Least squares in x = (i + 1/2)/kStretches - 1/2.
double EnergyRecord::Drift() const {
  double xy = 0, xx = 0;
  for (size_t i = 0; i < kStretches; ++i) {
    const double x = (static_cast<double>(i) + 0.5) / kStretches - 0.5;
    xy += x * Mean(i);
    xx += x * x;
  }
  return xy / xx;
}

double EnergyRecord::DriftError() const {
  const double slope = Drift(), mean = MeanOfMeans();
  double squares = 0, xx = 0;
  for (size_t i = 0; i < kStretches; ++i) {
    const double x = (static_cast<double>(i) + 0.5) / kStretches - 0.5;
    const double residual = Mean(i) - mean - slope * x;
    squares += residual * residual;
    xx += x * x;
  }
  return std::sqrt(squares / (kStretches - 2) / xx);
}

bool Drifts(const EnergyRun& run) {
  const double drift = std::fabs(run.record.Drift());
  // Written as a negation, so that a drift that is not a number counts as a trend.
  return !(drift <= 4 * run.record.DriftError() || drift <= 2.2e-16);
}

std::vector<EnergyRun> EnergyRuns(double effort) {
  constexpr uint64_t kPairs = 48;
  const auto hits = [effort](double full) {
    return std::max<uint64_t>(static_cast<uint64_t>(full * effort), 20'000);
  };
  const uint64_t all = hits(1e9);
  const std::string ball = "ball alone, u^2", pairs = "pairs", pair = "one pair";
  return {
      {"lanes", ball, all, 4, true, BallsInLanes(FlyLaneBalls, all)},
      {"lanes, single", ball, all, 4, false, BallsInLanes(FlyLaneBallsSingle, all)},
      {"lanes", pairs, all, kPairs, true, PairsByEngine(Engine::kLanes, kPairs, all / kPairs)},
      {"lanes, single", pairs, all, kPairs, false,
       PairsByEngine(Engine::kLanesSingle, kPairs, all / kPairs)},
      {"reference", pair, all, 1, true, PairByEvents<ReferenceFlow>(all)},
      {"reference, single", pair, hits(1e8), 1, false, PairByEvents<EventFlow<float>>(hits(1e8))},
      {"reference, 64 bits", pair, hits(1e7), 1, true,
       PairByEvents<EventFlow<long double>>(hits(1e7))},
      {"reference, 113 bits", pair, hits(1e6), 1, true,
       PairByEvents<EventFlow<Quadruple>>(hits(1e6))},
      {"nearest root", pair, hits(1e8), 1, false,
       PairByEvents<TextbookFlow<TextbookRule::kPositiveRoot>>(hits(1e8))},
      {"approaching disc", pair, hits(1e8), 1, false,
       PairByEvents<TextbookFlow<TextbookRule::kApproaching>>(hits(1e8))},
      {"fixed steps of 1e-3", pair, hits(1e6), 1, false, PairByEvents<FixedStepEvents>(hits(1e6))},
  };
}

}  // namespace ballpiston::stability
