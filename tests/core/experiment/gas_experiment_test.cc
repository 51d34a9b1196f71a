// How many replicas of a gas run together.
#include "core/experiment/gas_experiment.h"

#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// Blocks of one replica each. The run is asked to pause at every opportunity.
class SingleReplicas : public BlockQueue {
 public:
  SingleReplicas(uint64_t replicas, uint64_t chunk) : replicas_(replicas), chunk_(chunk) {}

  std::optional<Block> Next() override {
    if (next_ == replicas_) return std::nullopt;
    if (!has_result) ++taken_before_first_result;
    const uint64_t index = next_++;
    return Block{.chunk = chunk_, .index = index, .first = index, .samples = 1};
  }
  void Done(const Block&, BlockResult) override { has_result = true; }
  bool Pause() override { return true; }

  bool has_result = false;
  size_t taken_before_first_result = 0;

 private:
  uint64_t replicas_;
  uint64_t chunk_;
  uint64_t next_ = 0;
};

struct TogetherCase {
  Model model;
  int64_t columns;
  int64_t samples;
  size_t together;
};

// Lanes take 192 balls, but at most a quarter of the chunk; the other engines one replica.
TEST(GasExperiment, ARunTakesAQuarterOfItsChunkAtMost) {
  for (const TogetherCase& c :
       {TogetherCase{Model::kBilliard, 1, 64, 16}, TogetherCase{Model::kBilliard, 1, 3, 1},
        TogetherCase{Model::kBilliard, 1, 100'000, 192}, TogetherCase{Model::kBilliard, 30, 64, 7},
        TogetherCase{Model::kBilliard, 200, 64, 1}, TogetherCase{Model::kMarkov, 1, 64, 1},
        TogetherCase{Model::kBilliardReference, 1, 64, 1}}) {
    const auto point = PointExperiment::Create(
        SpecOf(&kGasEquilibrium, PaperGas(&kGasEquilibrium, 0.2, {c.columns}),
               {.samples = c.samples}, c.model, 42),
        0);
    const bool is_short = c.samples <= 64;  // one chunk
    SingleReplicas queue(is_short ? static_cast<uint64_t>(c.samples) : 200,
                         is_short ? 0 : point->plan().chunks() - 1);
    const std::unique_ptr<EngineRun> run = point->StartRun(queue);
    while (!queue.has_result) run->Advance();
    EXPECT_EQ(queue.taken_before_first_result, c.together)
        << Name(c.model) << " " << c.columns << " " << c.samples;
  }
}

}  // namespace
}  // namespace ballpiston
