#include "core/gas/weighted_bodies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/sampling/counter_random.h"
#include "tests/oracle/one_sample.h"

namespace ballpiston {
namespace {

// The least power of two above a weight; below 2^-31 that is 2^-31.
double BoundOf(double weight) {
  return weight < 0x1p-31 ? 0x1p-31 : std::exp2(std::floor(std::log2(weight)) + 1);
}

double SumOfBounds(const std::vector<double>& weights) {
  double sum = 0;
  for (const double weight : weights) sum += BoundOf(weight);
  return sum;
}

WeightedBodies BodiesOf(const std::vector<double>& weights) {
  WeightedBodies bodies(weights.size());
  for (size_t i = 0; i < weights.size(); ++i) bodies.Set(i, weights[i]);
  return bodies;
}

// Draws by body; the last count is that of no body. Bodies have weights above 0.
double ScoreOfDraws(const WeightedBodies& bodies, const std::vector<double>& weights) {
  constexpr int kDraws = 400'000;
  CounterRandom random(41, 0, 0);
  const double bound = bodies.Bound();
  std::vector<uint64_t> counts(weights.size() + 1);
  for (int i = 0; i < kDraws; ++i) {
    const std::optional<size_t> body = bodies.At(bound * random.Uniform());
    ++counts[body.value_or(weights.size())];
  }
  std::vector<double> probabilities;
  double none = 1;
  for (const double weight : weights)
    none -= weight / bound, probabilities.push_back(weight / bound);
  probabilities.push_back(none);
  return oracle::ChiSquareScoreOf(counts, probabilities);
}

// Weights that differ by 2^8, some exactly powers of two.
const std::vector<double> kWeights = {1,    2,   0.5,  0.51, 1.99, 3,    3,   7.9,
                                      0.25, 4.1, 0.03, 1,    1.5,  0.77, 6.5, 0.1};

// False alarms: 3e-5 in each of these two tests.
TEST(WeightedBodies, AreDrawnInProportionToTheirWeights) {
  EXPECT_LT(ScoreOfDraws(BodiesOf(kWeights), kWeights), 4);
}

TEST(WeightedBodies, AreDrawnInProportionAfterManyChanges) {
  CounterRandom random(41, 1, 0);
  WeightedBodies bodies(kWeights.size());
  std::vector<double> weights(kWeights.size());
  for (int i = 0; i < 10'000; ++i) {
    const size_t body = random.Bits() % weights.size();
    bodies.Set(body, weights[body] = 8 * std::pow(random.Uniform(), 3) + 0.01);
  }
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) bodies.Set(i, weights[i] = 1);
  }
  EXPECT_LT(ScoreOfDraws(bodies, weights), 4);
}

// The test of proportions detects weights that are a twentieth wrong.
TEST(WeightedBodies, WrongProportionsAreDetected) {
  std::vector<double> others = kWeights;
  others[5] *= 1.05;
  EXPECT_GT(ScoreOfDraws(BodiesOf(kWeights), others), 4);
}

TEST(WeightedBodies, TheBoundIsExactWhateverTheOrderOfChanges) {
  constexpr size_t kBodies = 300;
  CounterRandom random(41, 2, 0);
  WeightedBodies bodies(kBodies);
  std::vector<double> weights(kBodies);
  EXPECT_EQ(bodies.Bound(), kBodies * 0x1p-31);
  for (int i = 0; i < 20'000; ++i) {
    const size_t body = random.Bits() % kBodies;
    const double weight = std::exp2(40 * random.Uniform() - 35);
    bodies.Set(body, weights[body] = random.Uniform() < 0.05 ? 0 : weight);
    if (i % 100 != 0) continue;
    ASSERT_EQ(bodies.Bound(), SumOfBounds(weights)) << i;
  }
  EXPECT_EQ(bodies.Bound(), BodiesOf(weights).Bound());
}

// Every place below the bound is some body's, or nobody's: the share of each is its weight.
TEST(WeightedBodies, PlacesShareTheBound) {
  const std::vector<double> weights = {1, 0.75, 0, 3, 0.5};
  const WeightedBodies bodies = BodiesOf(weights);
  constexpr double kStep = 0x1p-9;
  std::vector<double> shares(weights.size());
  for (double place = kStep / 2; place < bodies.Bound(); place += kStep) {
    const std::optional<size_t> body = bodies.At(place);
    if (body) shares[*body] += kStep;
  }
  EXPECT_EQ(shares, weights);
}

TEST(WeightedBodies, ABodyOfWeightZeroIsNeverDrawn) {
  const WeightedBodies bodies = BodiesOf({0, 1e-12, 0});
  const double bound = bodies.Bound();
  CounterRandom random(41, 3, 0);
  for (int i = 0; i < 100'000; ++i) EXPECT_EQ(bodies.At(bound * random.Uniform()).value_or(1), 1u);
  EXPECT_EQ(bodies.At(0x1p-31), std::optional<size_t>(1));  // the second body begins there
}

}  // namespace
}  // namespace ballpiston
