#include "tests/server/fake_experiments.h"

#include <memory>
#include <utility>

namespace ballpiston::server {
namespace {

// SplitMix64: any three numbers make an unlike fourth.
double Uniform(uint64_t seed, uint64_t point, uint64_t sample) {
  uint64_t x = seed * 0x9e3779b97f4a7c15 + point * 0xbf58476d1ce4e5b9 + sample;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return static_cast<double>((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

BlockPlan FakePlan(const Target& target) {
  BlockPlan plan;
  plan.samples = kFakeSamplesPerBlock *
                 static_cast<uint64_t>(target.samples.value_or(target.collisions.value_or(1000)));
  plan.block_size = kFakeSamplesPerBlock;
  plan.tolerance = target.tolerance;
  return plan;
}

class FakeExperiment : public PointExperiment {
 public:
  FakeExperiment(const EnsembleSpec& spec, size_t index, BeforeBlock before_block)
      : PointExperiment(spec, PointAt(spec, index), FakePlan(spec.target)),
        seed_(spec.seed),
        index_(index),
        before_block_(std::move(before_block)) {}

  std::optional<BlockResult> RunBlock(uint64_t block, std::stop_token stop) const override {
    if (before_block_) before_block_(index_, block, stop);
    if (stop.stop_requested()) return std::nullopt;
    BlockResult result = EmptyResult();
    result.samples = plan().SamplesIn(block);
    for (uint64_t i = 0; i < result.samples; ++i) {
      result.moments[0].Add(Uniform(seed_, index_, plan().FirstSample(block) + i));
    }
    return result;
  }

  BlockResult EmptyResult() const override {
    BlockResult result;
    result.moments.resize(1);
    return result;
  }

  Estimate FirstEstimate(const BlockResult& merged) const override {
    return {"mean", merged.moments[0].mean, merged.moments[0].StandardError(), 0.5};
  }

  PointSummary Summarize(const BlockResult& merged) const override {
    PointSummary summary;
    summary.samples = merged.samples;
    summary.estimates = {FirstEstimate(merged)};
    return summary;
  }

 private:
  const uint64_t seed_;
  const size_t index_;
  const BeforeBlock before_block_;
};

class HeldUpExperiment : public PointExperiment {
 public:
  HeldUpExperiment(const EnsembleSpec& spec, size_t index, BeforeBlock before_block)
      : HeldUpExperiment(spec, PointExperiment::Create(spec, index), index,
                         std::move(before_block)) {}

  HeldUpExperiment(const EnsembleSpec& spec, std::unique_ptr<const PointExperiment> real,
                   size_t index, BeforeBlock before_block)
      : PointExperiment(spec, real->parameters(), real->plan()),
        real_(std::move(real)),
        index_(index),
        before_block_(std::move(before_block)) {}

  std::optional<BlockResult> RunBlock(uint64_t block, std::stop_token stop) const override {
    before_block_(index_, block, stop);
    if (stop.stop_requested()) return std::nullopt;  // a short block would not notice
    return real_->RunBlock(block, stop);
  }
  BlockResult EmptyResult() const override { return real_->EmptyResult(); }
  Estimate FirstEstimate(const BlockResult& merged) const override {
    return real_->FirstEstimate(merged);
  }
  PointSummary Summarize(const BlockResult& merged) const override {
    return real_->Summarize(merged);
  }

 private:
  const std::unique_ptr<const PointExperiment> real_;
  const size_t index_;
  const BeforeBlock before_block_;
};

}  // namespace

void Gate::Open() {
  std::lock_guard lock(mutex_);
  open_ = true;
  changed_.notify_all();
}

void Gate::Pass(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  ++waiting_;
  changed_.notify_all();
  changed_.wait(lock, stop, [this] { return open_; });
  --waiting_;
}

void Gate::AwaitWaiting(int count) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return waiting_ >= count; });
}

int Gate::waiting() {
  std::lock_guard lock(mutex_);
  return waiting_;
}

ExperimentFactory FakeExperiments(BeforeBlock before_block) {
  return [before_block = std::move(before_block)](const EnsembleSpec& spec, size_t index,
                                                  const std::stop_token&) {
    return std::make_unique<const FakeExperiment>(spec, index, before_block);
  };
}

ExperimentFactory FakeExperimentsBySeed(BeforeBlockOfSeed before_block) {
  return [before_block = std::move(before_block)](const EnsembleSpec& spec, size_t index,
                                                  const std::stop_token&) {
    return std::make_unique<const FakeExperiment>(
        spec, index,
        [before_block, seed = spec.seed](size_t point, uint64_t block, std::stop_token stop) {
          before_block(seed, point, block, stop);
        });
  };
}

ExperimentFactory GatedExperiments(Gate& gate, uint64_t first_block) {
  return FakeExperiments([&gate, first_block](size_t, uint64_t block, std::stop_token stop) {
    if (block >= first_block) gate.Pass(stop);
  });
}

ExperimentFactory HeldUpExperiments(BeforeBlock before_block) {
  return [before_block = std::move(before_block)](const EnsembleSpec& spec, size_t index,
                                                  const std::stop_token&) {
    return std::make_unique<const HeldUpExperiment>(spec, index, before_block);
  };
}

EnsembleSpec FakeSpec(int points, int64_t blocks, uint64_t seed) {
  EnsembleSpec spec;
  spec.experiment = Experiment::kEquilibrium;
  spec.grid.rho = {0.53};
  for (int i = 0; i < points; ++i) spec.grid.delta.push_back(0.1 + 1e-6 * i);
  spec.target.samples = blocks;
  spec.seed = seed;
  return spec;
}

BlockResult FakeMerged(const EnsembleSpec& spec, size_t point, uint64_t blocks) {
  const auto experiment = FakeExperiments()(spec, point, std::stop_token());
  BlockResult merged;
  for (uint64_t block = 0; block < blocks; ++block) {
    merged.Merge(*experiment->RunBlock(block, std::stop_token()));
  }
  return merged;
}

}  // namespace ballpiston::server
