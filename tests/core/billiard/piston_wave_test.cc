#include "core/billiard/piston_wave.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// A ball on its way, and a piston.
struct Approach {
  double phase, ratio, x, ux, length;
};

std::optional<PistonWave::Collision> FirstCollision(const PistonWave& wave, const Approach& a) {
  return wave.FirstCollision(a.phase, a.ratio, a.x, a.ux, a.length);
}

// Starts apart, or touching and moving apart.
Approach Drawn(const PistonWave& wave, CounterRandom& random) {
  const double angle = 2 * M_PI * random.Uniform();
  Approach a = {.phase = 2 * wave.stroke() * random.Uniform(),
                .ratio = std::pow(10, 4 * random.Uniform() - 2),
                .x = 0,
                .ux = std::cos(angle),
                .length = 0.6 * random.Uniform()};
  const double piston = wave.Position(a.phase) - wave.left();
  const double velocity = a.phase < wave.stroke() ? a.ratio : -a.ratio;
  const bool touches = random.Uniform() < 0.3 && velocity > a.ux;
  a.x = touches ? piston : piston - 0.5 * random.Uniform();
  return a;
}

// For slow balls the piston's phase has no correct digit, but FirstCollision must still have an
// answer.
TEST(PistonWave, FirstCollisionOfASlowBallIsOnItsPath) {
  const PistonWave wave(PaperGeometry(0.01));
  for (uint64_t i = 0; i < 3000; ++i) {
    CounterRandom random(3, 4, i);
    Approach a = Drawn(wave, random);
    a.ratio = std::pow(10, 6 + 12 * random.Uniform());
    const std::optional<PistonWave::Collision> collision = FirstCollision(wave, a);
    const double farthest = a.x + a.ux * a.length;
    if (farthest > 1e-3 && a.x > 1e-3) {
      ASSERT_TRUE(collision);  // the piston comes past many times
    }
    if (!collision) continue;
    ASSERT_GE(collision->way, 0);
    ASSERT_LE(collision->way, a.length);
    ASSERT_GT(a.x + a.ux * collision->way, -1e-15);
  }
}

TEST(PistonWave, CollisionsInSpecialCases) {
  const PistonWave wave(PaperGeometry(0.1));
  const double stroke = wave.stroke();
  struct Case {
    const char* what;
    Approach approach;
    std::optional<double> way;
  };
  for (const Case& row :
       {Case{"a ball that stands", {0.05, 1, -0.01, 0, 0.5}, {}},
        {"a ball that leaves", {0.05, 1, -0.01, -1, 0.5}, {}},
        {"a ball that hardly leaves", {0.05, 1, -0.01, -1e-300, 0.5}, {}},
        {"a ball that hardly comes", {0.05, 1, -0.01, 1e-300, 0.5}, {}},
        {"a ball that does not come so far", {2 * stroke, 0, -0.01, 1, 0.005}, {}},
        {"a piston at rest", {0.07, 0, -0.2, 0.5, 1}, 0.27 / 0.5},
        // The ball touches the piston and moves in the same direction, slower.
        {"the piston returns", {0.05, 1e18, 0.05, 1, 0.3}, 2 * (stroke - 0.05) / 1e18}}) {
    const auto collision = FirstCollision(wave, row.approach);
    ASSERT_EQ(collision.has_value(), row.way.has_value()) << row.what;
    if (!collision) continue;
    EXPECT_NEAR(collision->way / *row.way, 1, 1e-12) << row.what;
    EXPECT_FALSE(collision->piston_goes_right && row.approach.ratio > 0) << row.what;
  }
}

TEST(PistonWave, HitsAreCountedUpToTheLargestCount) {
  const PistonWave wave(PaperGeometry(0.1));
  EXPECT_EQ(wave.Hits(0.5 * wave.stroke(), 2.75 * wave.stroke()), 3u);
  EXPECT_EQ(wave.Hits(0, 1e30), uint64_t{1} << 63);
}

}  // namespace
}  // namespace ballpiston
