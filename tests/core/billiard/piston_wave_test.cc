#include "core/billiard/piston_wave.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// For slow balls the piston's phase has no correct digit, but FirstCollision must still have an
// answer. The ball starts apart from the piston, or touches it and moves apart.
TEST(PistonWave, FirstCollisionOfASlowBallIsOnItsPath) {
  const PistonWave wave(PaperGeometry(0.01));
  for (uint64_t i = 0; i < 3000; ++i) {
    CounterRandom random(3, 4, i);
    const double phase = 2 * wave.stroke() * random.Uniform();
    const double ratio = std::pow(10, 6 + 12 * random.Uniform());
    const double ux = std::cos(2 * M_PI * random.Uniform()), length = 0.6 * random.Uniform();
    const bool touches = random.Uniform() < 0.3 && phase < wave.stroke();
    const double apart = touches ? 0 : 0.5 * random.Uniform();
    const double x = wave.Position(phase) - wave.left() - apart;
    const auto collision = wave.FirstCollision(phase, ratio, x, ux, length);
    if (x + ux * length > 1e-3 && x > 1e-3) {
      ASSERT_TRUE(collision);  // the piston comes past many times
    }
    if (!collision) continue;
    ASSERT_GE(collision->way, 0);
    ASSERT_LE(collision->way, length);
    ASSERT_GT(x + ux * collision->way, -1e-15);
  }
}

TEST(PistonWave, CollisionsInSpecialCases) {
  const PistonWave wave(PaperGeometry(0.1));
  const double stroke = wave.stroke();
  struct Case {
    const char* what;
    double phase, ratio, x, ux, length;
    std::optional<double> way = {};
  };
  for (const Case& row :
       {Case{"a ball that stands", 0.05, 1, -0.01, 0, 0.5},
        {"a ball that leaves", 0.05, 1, -0.01, -1, 0.5},
        {"a ball that hardly leaves", 0.05, 1, -0.01, -1e-300, 0.5},
        {"a ball that hardly comes", 0.05, 1, -0.01, 1e-300, 0.5},
        {"a ball that does not come so far", 2 * stroke, 0, -0.01, 1, 0.005},
        {"a piston at rest", 0.07, 0, -0.2, 0.5, 1, 0.27 / 0.5},
        // The ball touches the piston and moves in the same direction, slower.
        {"the piston returns", 0.05, 1e18, 0.05, 1, 0.3, 2 * (stroke - 0.05) / 1e18}}) {
    const auto collision = wave.FirstCollision(row.phase, row.ratio, row.x, row.ux, row.length);
    ASSERT_EQ(collision.has_value(), row.way.has_value()) << row.what;
    if (!collision) continue;
    EXPECT_NEAR(collision->way / *row.way, 1, 1e-12) << row.what;
    EXPECT_FALSE(collision->piston_goes_right && row.ratio > 0) << row.what;
  }
}

TEST(PistonWave, HitsAreCountedUpToTheLargestCount) {
  const PistonWave wave(PaperGeometry(0.1));
  EXPECT_EQ(wave.Hits(0.5 * wave.stroke(), 2.75 * wave.stroke()), 3u);
  EXPECT_EQ(wave.Hits(0, 1e30), uint64_t{1} << 63);
}

}  // namespace
}  // namespace ballpiston
