#include "tools/stability/reversal.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/billiard/reference_flow.h"
#include "core/geometry/paper.h"
#include "core/sampling/invariant_measure.h"
#include "tools/flows/lane_balls.h"
#include "tools/flows/numbered_orbits.h"
#include "tools/flows/precise_flow.h"
#include "tools/stability/fixed_step_events.h"
#include "tools/stability/flow_precision.h"
#include "tools/stability/markdown_table.h"
#include "tools/stability/pair_starts.h"
#include "tools/stability/textbook_flow.h"

namespace ballpiston::stability {
namespace {

constexpr uint64_t kReversalSeed = 22;
constexpr uint64_t kReversalHits[] = {1, 2, 5, 10, 20, 30};

using Starts = std::vector<PairState>;
using Distances = std::vector<double>;

PairGeometry Geometry() { return *PairGeometry::Create(kPaperRho, 0.1); }

Starts DrawnStarts(uint64_t stream, uint64_t count,
                   PairState (*draw)(const PairGeometry&, CounterRandom&)) {
  Starts starts;
  for (uint64_t i = 0; i < count; ++i) {
    CounterRandom random(kReversalSeed, stream, i);
    starts.push_back(draw(Geometry(), random));
  }
  return starts;
}

// Not a number if there are too few values.
double Median(Distances values) {
  constexpr size_t kEnough = 50;
  if (values.size() < kEnough) return std::nan("");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// ---- the ball alone ----

template <typename Real>
using VectorOf = typename PairStateOf<Real>::Vector;

template <typename Real>
VectorOf<Real> Normalized(const VectorOf<Real>& v) {
  using std::sqrt;
  return v / Real(sqrt(v.squaredNorm()));
}

// The centre of the disc in the ball's quadrant, and the disc's outward unit normal at the ball.
template <typename Real>
VectorOf<Real> CentreAt(const VectorOf<Real>& position) {
  const auto half = [](const Real& x) { return static_cast<Real>(x > 0 ? 0.5 : -0.5); };
  return {half(position.x()), half(position.y())};
}
template <typename Real>
VectorOf<Real> NormalAt(const VectorOf<Real>& position) {
  return Normalized<Real>(position - CentreAt<Real>(position));
}

// A start in double, moved onto its wall and with a unit direction in the flow's own precision.
template <typename Real>
PairStateOf<Real> OnWall(const PairState& start) {
  PairStateOf<Real> state = RoundedTo<Real>(start);
  state.direction = Normalized<Real>(state.direction);
  state.position = CentreAt<Real>(state.position) +
                   static_cast<Real>(Geometry().rho()) * NormalAt<Real>(state.position);
  return state;
}

// The state from which the reversed orbit starts, for a ball on a wall. The reversed velocity is
// reflected at the normal, so that the ball need not hit its present wall first.
template <typename Real>
PairStateOf<Real> Reversed(PairStateOf<Real> state) {
  const VectorOf<Real> normal = NormalAt<Real>(state.position);
  state.direction = normal * (2 * state.direction.dot(normal)) - state.direction;
  return state;
}

// False if the ball escaped.
template <typename Flow>
bool Fly(Flow& flow, uint64_t hits) {
  for (uint64_t i = 0; i < hits; ++i) {
    if (flow.Step().kind != EventKind::kBallWall) return false;
  }
  return true;
}

template <typename Flow>
Distances ByEvents(const Starts& starts, uint64_t hits) {
  using Real = RealOf<Flow>;
  using std::sqrt;
  Distances distances;
  for (const PairState& start : starts) {
    const PairStateOf<Real> from = OnWall<Real>(start);
    Flow there(Geometry(), from);
    bool stayed = Fly(there, hits);
    Flow back(Geometry(), Reversed(there.state()));
    stayed = stayed && Fly(back, hits);
    const VectorOf<Real> apart = back.state().position - from.position;
    distances.push_back(stayed ? static_cast<double>(Real(sqrt(apart.squaredNorm()))) : HUGE_VAL);
  }
  return distances;
}

template <FlyLanes& fly>
Distances InLanes(const Starts& starts, uint64_t hits) {
  std::vector<LaneHit> last(starts.size());
  fly(Geometry(), OnTheirWalls(starts), hits, last);
  Starts turned;
  for (const auto& [frame, length, x] : last) {
    turned.push_back(Reversed(
        PairState{.position = PositionInCell(frame), .direction = DirectionInCell(frame)}));
  }
  fly(Geometry(), OnTheirWalls(turned), hits, last);
  Distances distances;
  for (size_t i = 0; i < last.size(); ++i) {
    distances.push_back((PositionInCell(last[i].frame) - starts[i].position).norm());
  }
  return distances;
}

// ---- ball and piston ----

// The first collision of each orbit.
class FirstCollisions : public NumberedOrbits {
 public:
  FirstCollisions(Engine engine, Starts starts)
      : starts_(std::move(starts)), collisions_(starts_.size()) {
    RunOrbits(engine, Geometry(), starts_.size(), *this);
  }

  PairState Start(uint64_t orbit) override { return starts_[orbit]; }
  AfterCollision Collide(uint64_t orbit, const Collision& collision) override {
    collisions_[orbit] = collision;
    return AfterCollision::kEnd;
  }

  const Collision& operator[](size_t orbit) const { return collisions_[orbit]; }

 private:
  Starts starts_;
  std::vector<Collision> collisions_;
};

// The distances of orbits with this number of hits; `starts` are just after a collision.
class PairReversal {
 public:
  PairReversal(Engine engine, const Starts& starts)
      : starts_(starts), there_(engine, starts), back_(engine, Turned()) {}

  Distances AfterHits(uint64_t hits) const {
    Distances distances;
    for (size_t i = 0; i < starts_.size(); ++i) {
      if (there_[i].ball_wall_hits != hits) continue;
      distances.push_back((back_[i].state.position - starts_[i].position).norm());
    }
    return distances;
  }

 private:
  Starts Turned() const {
    Starts turned;
    for (size_t i = 0; i < starts_.size(); ++i) {
      PairState& state = turned.emplace_back(there_[i].state);
      state.direction = -state.direction;
      state.piston_velocity = -state.piston_velocity;
    }
    return turned;
  }

  const Starts& starts_;
  FirstCollisions there_;
  FirstCollisions back_;
};

// ---- the table ----

void AddRow(const char* what, const char* method,
            const std::function<Distances(uint64_t hits)>& distances, MarkdownTable& table) {
  std::vector<std::string> row = {what, method};
  for (const uint64_t hits : kReversalHits) row.push_back(ErrorText(Median(distances(hits))));
  table.Add(row);
}

void AddBalls(uint64_t orbits, MarkdownTable& table) {
  using enum TextbookRule;
  const Starts starts = DrawnStarts(0, orbits, AnywhereOnWall);
  const auto add = [&](const char* method, Distances (*fly)(const Starts&, uint64_t)) {
    AddRow(
        "ball alone", method, [&](uint64_t hits) { return fly(starts, hits); }, table);
  };
  add("lanes", InLanes<FlyLaneBalls>);
  add("lanes, single", InLanes<FlyLaneBallsSingle>);
  add("reference", ByEvents<ReferenceFlow>);
  add("reference, single", ByEvents<EventFlow<float>>);
  add("reference, 64 bits", ByEvents<EventFlow<long double>>);
  add("reference, 113 bits", ByEvents<EventFlow<Quadruple>>);
  add("nearest root", ByEvents<TextbookFlow<kPositiveRoot>>);
  add("nearest root, no threshold", ByEvents<TextbookFlow<kAnyRoot>>);
  add("approaching disc", ByEvents<TextbookFlow<kApproaching>>);
  add("unit speed assumed", ByEvents<TextbookFlow<kUnitSpeed>>);
  add("fixed steps of 1e-3", ByEvents<FixedStepEvents>);
}

void AddPairs(uint64_t orbits, MarkdownTable& table) {
  const Starts starts = DrawnStarts(1, orbits, DrawFromCollisionMeasure);
  const auto add = [&](const char* method, Engine engine) {
    const PairReversal reversal(engine, starts);
    AddRow(
        "from collision to collision with the piston", method,
        [&](uint64_t hits) { return reversal.AfterHits(hits); }, table);
  };
  add("lanes", Engine::kLanes);
  add("lanes, single", Engine::kLanesSingle);
  add("reference", Engine::kReference);
}

}  // namespace

std::string ReversalTable(uint64_t orbits) {
  std::vector<std::string> head = {"what", "method"};
  for (const uint64_t hits : kReversalHits) head.push_back(absl::StrCat(hits, " hits"));
  MarkdownTable table(head);
  AddBalls(orbits, table);
  AddPairs(20 * orbits, table);
  return table.Text(2);
}

}  // namespace ballpiston::stability
