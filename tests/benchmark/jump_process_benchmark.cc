// Jumps a second of the pair's jump process: the scalar definition, the lanes with every
// instruction set, and the parts of a jump in lanes; beside them the collisions a second of the
// billiard that the process is the limit of.
//
//   jump_process_benchmark
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/geometry/paper.h"
#include "core/markov/jump_process.h"
#include "core/sampling/counter_random.h"
#include "core/sampling/invariant_measure.h"
#include "tests/benchmark/turns.h"
#include "tests/benchmark/vector_targets.h"
#include "tests/oracle/scalar_jump.h"
#include "tools/flows/numbered_orbits.h"

namespace ballpiston {
namespace {

constexpr double kDelta = 0.0125;

// Starts in equilibrium and ends an orbit after some collisions.
class Equilibrium : public NumberedOrbits {
 public:
  Equilibrium(const PairGeometry& geometry, uint64_t orbits)
      : geometry_(geometry), collisions_(orbits) {}

  PairState Start(uint64_t orbit) override {
    CounterRandom random(1, 2, orbit);
    return DrawFromCollisionMeasure(geometry_, random);
  }
  AfterCollision Collide(uint64_t orbit, const Collision&) override {
    return ++collisions_[orbit] == kCollisions ? AfterCollision::kEnd : AfterCollision::kGoOn;
  }

  static constexpr uint64_t kCollisions = 4;

 private:
  PairGeometry geometry_;
  std::vector<uint64_t> collisions_;
};

double CollisionsOfTheBilliard(uint64_t) {
  constexpr uint64_t kOrbits = 1000;
  const PairGeometry geometry = *PairGeometry::Create(kPaperRho, kDelta);
  Equilibrium source(geometry, kOrbits);
  RunOrbits(Engine::kLanes, geometry, kOrbits, source);
  return double{kOrbits * Equilibrium::kCollisions};
}

double ScalarJumps(uint64_t turn) {
  constexpr int kJumps = 10'000;
  double u = 0.5;
  CounterRandom random(1, 2, turn);
  for (int n = 0; n < kJumps; ++n) {
    const double waiting = random.Uniform();
    const oracle::Jump jump = oracle::JumpFrom(u, waiting, random.Uniform());
    Keep(jump.waiting_time);
    u = jump.u;
  }
  return kJumps;
}

double JumpsInLanes(int64_t target) {
  constexpr size_t kWalkers = 1024;
  constexpr int kJumps = 200;
  Use(target);
  JumpWalkers walkers(1, 2, 3, std::vector<double>(kWalkers, 0.5));
  for (int n = 0; n < kJumps; ++n) walkers.Jump();
  Keep(walkers.u()[0]);
  return double{kWalkers * kJumps};
}

// The parts of a jump in lanes, each for two jumps of every walker of a group.
constexpr int kGroups = 1000;

double WordsOfJumps(uint64_t turn) {
  JumpWords drawn;
  for (uint64_t n = 0; n < kGroups; ++n) DrawJumpWords(1, 2, 3, turn * kGroups + n, drawn);
  Keep(static_cast<double>(drawn.words[0][0]));
  return 2.0 * kJumpGroup * kGroups;
}

double JumpsOfGivenWords(uint64_t) {
  JumpWords drawn;
  DrawJumpWords(1, 2, 3, 4, drawn);
  std::vector<double> u(kJumpGroup, 0.5), times(kJumpGroup);
  for (int n = 0; n < kGroups; ++n) {
    for (size_t word = 0; word < 4; word += 2) {
      JumpInLanes(drawn.words[word], drawn.words[word + 1], u.data(), times.data());
    }
  }
  Keep(times[0]);
  return 2.0 * kJumpGroup * kGroups;
}

// The first is the yardstick of the ratios.
std::vector<Contender> Contenders() {
  std::vector<Contender> all = {
      {"jumps, scalar", ScalarJumps},
      {"collisions of the billiard, delta 0.0125", CollisionsOfTheBilliard}};
  for (const int64_t target : VectorTargets()) {
    all.push_back({absl::StrCat("jumps, lanes ", hwy::TargetName(target)),
                   [target](uint64_t) { return JumpsInLanes(target); }});
  }
  all.push_back({"of which random words", WordsOfJumps});
  all.push_back({"of which the jumps", JumpsOfGivenWords});
  return all;
}

}  // namespace
}  // namespace ballpiston

int main() { ballpiston::ShowRates(ballpiston::Contenders(), 30, " times the first"); }
