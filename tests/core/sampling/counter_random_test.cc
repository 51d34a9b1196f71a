#include "core/sampling/counter_random.h"

#include "core/sampling/direction.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

std::vector<uint64_t> Draws(uint64_t seed, uint64_t stream, uint64_t sample) {
  CounterRandom random(seed, stream, sample);
  std::vector<uint64_t> draws(9);
  for (uint64_t& draw : draws) draw = random.Bits();
  return draws;
}

// The published known-answer vector of Philox4x64-10 for key and counter zero.
TEST(CounterRandom, IsPhilox4x64) {
  CounterRandom random(0, 0, 0);
  EXPECT_EQ(random.Bits(), 0x16554d9eca36314cu);
  EXPECT_EQ(random.Bits(), 0xdb20fe9d672d0fdcu);
  EXPECT_EQ(random.Bits(), 0xd7e772cee186176bu);
  EXPECT_EQ(random.Bits(), 0x7e68b68aec7ba23bu);
}

// A block is the next four words of the same sequence, also if words of the previous block are
// unused.
TEST(CounterRandom, BlocksContinueTheSameSequence) {
  CounterRandom words(1, 2, 3), blocks(1, 2, 3);
  uint64_t block[CounterRandom::kBlock];
  EXPECT_EQ(blocks.Bits(), words.Bits());
  blocks.DrawBlock(block);
  for (size_t i = 1; i < CounterRandom::kBlock; ++i) EXPECT_EQ(blocks.Bits(), words.Bits());
  for (const uint64_t word : block) EXPECT_EQ(word, words.Bits());
  EXPECT_EQ(blocks.Bits(), words.Bits());
}

TEST(CounterRandom, DependsOnlyOnSeedStreamAndSample) {
  EXPECT_EQ(Draws(1, 2, 3), Draws(1, 2, 3));
  const std::set<std::vector<uint64_t>> distinct = {Draws(1, 2, 3), Draws(2, 2, 3), Draws(1, 3, 3),
                                                    Draws(1, 2, 4), Draws(2, 1, 3)};
  EXPECT_EQ(distinct.size(), 5u);
}

// Mean 1/2 and variance 1/12; windows of 5 standard errors at 1e6 draws: false alarms 1e-6.
TEST(CounterRandom, UniformIsUniformAndOpen) {
  CounterRandom random(5, 0, 0);
  Moments moments;
  for (int i = 0; i < 1'000'000; ++i) {
    const double u = random.Uniform();
    ASSERT_GT(u, 0);
    ASSERT_LT(u, 1);
    moments.Add(u);
  }
  EXPECT_NEAR(moments.mean, 0.5, 5 * *moments.StandardError());
  EXPECT_NEAR(*moments.Variance(), 1.0 / 12, 5 * std::sqrt(1.0 / 180 / 1e6));
}

TEST(UniformDirection, HasLengthOneAndIsIsotropic) {
  CounterRandom random(6, 0, 0);
  Moments cosine, cosine_of_double, cosine_of_quadruple;
  for (int i = 0; i < 1'000'000; ++i) {
    const Eigen::Vector2d u = UniformDirection(random);
    ASSERT_NEAR(u.norm(), 1, 4e-16);
    const double c2 = 2 * u.x() * u.x() - 1;
    cosine.Add(u.x());
    cosine_of_double.Add(c2);
    cosine_of_quadruple.Add(2 * c2 * c2 - 1);
  }
  for (const Moments& moments : {cosine, cosine_of_double, cosine_of_quadruple}) {
    EXPECT_NEAR(moments.mean, 0, 5 * *moments.StandardError());  // false alarms 1e-6 each
  }
}

}  // namespace
}  // namespace ballpiston
