// Samples that continue each other, with the experiment `gas-conduction`.
#include "core/experiment/steady_gas.h"

#include "core/ensemble/point_fold.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

std::unique_ptr<const PointExperiment> PointOf(Model model, int64_t samples = 2000) {
  return PointExperiment::Create(
      SpecOf(&kGasConduction, PaperGas(&kGasConduction, 0.2), {.samples = samples}, model, 5), 0);
}

// Computes one chunk at a time, each in a fold of its own. Any chunk that can start may be next.
BlockResult ByRandomChunks(const PointExperiment& point, unsigned seed) {
  std::mt19937 random(seed);
  PointFold fold(point);
  while (!fold.finished()) {
    std::vector<uint64_t> startable;
    for (uint64_t chunk = 0; chunk < point.plan().chunks(); ++chunk) {
      if (fold.Needs(chunk) && fold.CanStart(chunk)) startable.push_back(chunk);
    }
    const uint64_t chunk = startable[random() % startable.size()];
    std::vector<GroupState> starts(point.plan().groups());
    starts[chunk % starts.size()] = fold.StartOf(chunk);
    ChunkFold one(point.plan(), {chunk}, chunk + 1, starts);
    const Block block = *one.NextBlock();
    EXPECT_FALSE(one.NextBlock());
    for (ChunkResult& done : one.Add(block, RunBlock(point, block))) fold.Add(std::move(done));
  }
  return fold.Merged();
}

TEST(SteadyGas, AnyDivisionGivesTheSameBits) {
  for (const Model model : kModelsThatSampleGases) {
    const auto point = PointOf(model);
    const BlockResult whole = FoldPoint(*point);
    for (const unsigned seed : {1u, 2u}) {
      EXPECT_EQ(ByRandomChunks(*point, seed), whole) << Name(model);
    }
  }
}

TEST(SteadyGas, ADamagedStateCannotContinue) {
  const auto point = PointOf(Model::kBilliard, 1);
  const GroupState state = FoldPoint(*point).groups[3];
  EXPECT_TRUE(point->CanContinue(state));
  EXPECT_FALSE(point->CanContinue({}));
  const auto with = [&](size_t place, double number) {
    std::vector<double> numbers(state.numbers().begin(), state.numbers().end());
    numbers[place] = number;
    return GroupState(std::move(numbers));
  };
  const size_t last = state.numbers().size() - 1;  // a piston's velocity, after its offset
  EXPECT_FALSE(point->CanContinue(with(last, std::nan(""))));
  EXPECT_FALSE(point->CanContinue(with(last - 1, 0.9)));
  EXPECT_FALSE(point->CanContinue(with(0, -1)));
  EXPECT_FALSE(point->CanContinue(with(1, 1e9)));
  std::vector<double> more(state.numbers().begin(), state.numbers().end());
  more.push_back(0);
  EXPECT_FALSE(point->CanContinue(GroupState(std::move(more))));
}

// The variance of 4,000 energies has a standard error of 3 %. The tolerance is 5 standard errors,
// so a false alarm has the probability 6e-7 for each shape.
TEST(SteadyGas, VarianceOfEnergyIsThatOfItsStarts) {
  for (const GasShape& shape : {GasShape{3}, GasShape{3, 2, true}}) {
    const auto point = PointExperiment::Create(
        SpecOf(&kGasConduction, PaperGas(&kGasConduction, 0.2, shape), {}, Model::kBilliard), 0);
    const auto& gas = dynamic_cast<const SteadyGas&>(*point);
    Moments energies;
    for (uint64_t start = 0; start < 4000; ++start) {
      CounterRandom random(1, 2, start);
      energies.Add(EnergyOf(DrawGas(gas.geometry(), gas.TemperaturesAtStart(), random)));
    }
    EXPECT_NEAR(*energies.Variance() / gas.VarianceOfEnergy(), 1, 0.15);
  }
}

}  // namespace
}  // namespace ballpiston
