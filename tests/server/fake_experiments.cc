#include "tests/server/fake_experiments.h"

#include "tests/server/preamble.h"
#include "tests/support/dice.h"

namespace ballpiston::server {
namespace {

// From the three numbers.
double Uniform(uint64_t seed, uint64_t point, uint64_t sample) {
  return Dice(seed * 0x9e3779b97f4a7c15 + point * 0xbf58476d1ce4e5b9 + sample).Uniform();
}

// Blocks of kFakeSamplesPerBlock, in chunks of 64 samples, 128, 256 ...
ChunkPlan FakePlan(const Target& target) {
  const auto blocks =
      static_cast<uint64_t>(target.samples.value_or(target.collisions.value_or(1000)));
  return ChunkPlan(kFakeSamplesPerBlock * blocks, Engine::kLanes, 0x1p23);
}

class FakeExperiment : public PointExperiment {
 public:
  FakeExperiment(const EnsembleSpec& spec, size_t index, BeforeBlockOfSeed before_block)
      : PointExperiment(spec, PointAt(spec, index), FakePlan(spec.target)),
        seed_(spec.seed),
        index_(index),
        before_block_(std::move(before_block)) {
    SetMeasurements({.moments = std::vector<Moments>(1)},
                    {{.name = "mean", .reading = Mean, .exact = 0.5}});
  }

  std::unique_ptr<EngineRun> StartRun(BlockQueue& queue) const override {
    return RunOneByOne(queue, [this](const Block& block, const std::stop_token& stop) {
      return Compute(block, stop);
    });
  }

 private:
  // With an error for any number of samples.
  static Estimate Mean(const BlockResult& merged) {
    return {.value = merged.moments[0].mean, .standard_error = merged.moments[0].StandardError()};
  }

  std::optional<BlockResult> Compute(const Block& block, const std::stop_token& stop) const {
    before_block_(seed_, index_, block.first / kFakeSamplesPerBlock, stop);
    if (stop.stop_requested()) return std::nullopt;
    BlockResult result = EmptyResult();
    result.samples = block.samples;
    for (uint64_t i = 0; i < block.samples; ++i) {
      result.moments[0].Add(Uniform(seed_, index_, block.first + i));
    }
    return result;
  }

  const uint64_t seed_;
  const size_t index_;
  const BeforeBlockOfSeed before_block_;
};

LocalPoint AfterBlocks(const PointExperiment& experiment, uint64_t blocks) {
  LocalPoint point(experiment);
  for (uint64_t i = 0; i < blocks; ++i) {
    const std::optional<Block> block = point.NextBlock();
    point.Add(*block, RunBlock(experiment, *block));
  }
  return point;
}

}  // namespace

ExperimentFactory FakeExperiments(BeforeBlock before_block) {
  return FakeExperimentsBySeed([before_block = std::move(before_block)](
                                   uint64_t, size_t point, uint64_t block, std::stop_token stop) {
    if (before_block) before_block(point, block, stop);
  });
}

ExperimentFactory FakeExperimentsBySeed(BeforeBlockOfSeed before_block) {
  return [before_block = std::move(before_block)](const EnsembleSpec& spec, size_t index) {
    return std::make_unique<const FakeExperiment>(spec, index, before_block);
  };
}

ExperimentFactory GatedExperiments(Gate& gate, uint64_t first_block) {
  return FakeExperiments([&gate, first_block](size_t, uint64_t block, std::stop_token stop) {
    if (block >= first_block) gate.Pass(stop);
  });
}

EnsembleSpec FakeSpec(int points, int64_t blocks, uint64_t seed) {
  EnsembleSpec spec;
  spec.experiment = &kEquilibrium;
  spec.grid[kRho] = {0.53};
  for (int i = 0; i < points; ++i) spec.grid[kDelta].push_back(0.1 + 1e-6 * i);
  spec.target.samples = blocks;
  spec.seed = seed;
  return spec;
}

FoldState FakeState(const EnsembleSpec& spec, size_t point, uint64_t blocks) {
  return AfterBlocks(*FakeExperiments()(spec, point), blocks).State();
}

BlockResult FakeMerged(const EnsembleSpec& spec, size_t point, uint64_t blocks) {
  return AfterBlocks(*FakeExperiments()(spec, point), blocks).Merged();
}

}  // namespace ballpiston::server
