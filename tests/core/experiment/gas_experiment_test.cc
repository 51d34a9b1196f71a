// The common properties of both experiments with a gas, by every model that samples.
#include "core/experiment/gas_experiment.h"

#include "core/ensemble/point_fold.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

constexpr const ExperimentKind* kGases[] = {&kGasEquilibrium, &kGasConduction};

std::vector<EnsembleSpec> OneOfEach(int64_t replicas) {
  std::vector<EnsembleSpec> specs;
  for (const ExperimentKind* kind : kGases) {
    for (const Model model : kModelsThatSampleGases) {
      for (const GasShape& shape : {GasShape{2}, GasShape{2, 1, true}}) {
        specs.push_back(SpecOf(kind, PaperGas(kind, 0.2, shape), {.samples = replicas}, model, 42));
      }
    }
  }
  return specs;
}

std::string Described(const EnsembleSpec& spec) {
  return absl::StrCat(spec.experiment->name, " of ", Text(ShapeOf(spec.grid[kCells][0])), " by ",
                      Name(spec.model));
}

// Blocks of so many replicas. The run is asked to pause after every slice if `pauses`.
class ListedBlocks : public BlockQueue {
 public:
  ListedBlocks(std::vector<Block> blocks, bool pauses)
      : blocks_(std::move(blocks)), pauses_(pauses) {}

  std::optional<Block> Next() override {
    if (next_ == blocks_.size()) return std::nullopt;
    if (results.empty()) ++taken_before_first_result;
    return blocks_[next_++];
  }
  void Done(const Block& block, BlockResult result) override {
    EXPECT_TRUE(results.emplace(block.first, std::move(result)).second) << "computed twice";
  }
  bool Pause() override { return pauses_; }
  std::stop_token stop() const override { return {}; }

  std::map<uint64_t, BlockResult> results;
  size_t taken_before_first_result = 0;

 private:
  std::vector<Block> blocks_;
  size_t next_ = 0;
  bool pauses_;
};

std::vector<Block> BlocksOf(uint64_t replicas, uint64_t each) {
  std::vector<Block> blocks;
  for (uint64_t first = 0; first < replicas; first += each) {
    blocks.push_back({.index = first / each, .first = first, .samples = each});
  }
  return blocks;
}

TEST(GasExperiment, BlocksComputedTogetherEqualThoseComputedAlone) {
  for (const EnsembleSpec& spec : OneOfEach(12)) {
    SCOPED_TRACE(Described(spec));
    const auto point = PointExperiment::Create(spec, 0);
    const std::vector<Block> blocks = BlocksOf(12, 3);
    ListedBlocks together(blocks, false), paused(blocks, true);
    EXPECT_TRUE(point->StartRun(together)->Advance());
    const std::unique_ptr<EngineRun> run = point->StartRun(paused);
    int calls = 1;
    while (!run->Advance()) ++calls;
    EXPECT_GT(calls, 1);
    ASSERT_EQ(together.results.size(), blocks.size());
    EXPECT_EQ(paused.results, together.results);
    for (const Block& block : blocks) {
      EXPECT_EQ(*RunBlock(*point, block), together.results.at(block.first));
    }
  }
}

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
    std::vector<Block> blocks = BlocksOf(200, 1);
    for (Block& block : blocks) block.chunk = point->plan().chunks() - 1;
    if (c.samples <= 64) blocks = BlocksOf(static_cast<uint64_t>(c.samples), 1);
    ListedBlocks queue(blocks, true);
    const std::unique_ptr<EngineRun> run = point->StartRun(queue);
    while (queue.results.empty()) run->Advance();
    EXPECT_EQ(queue.taken_before_first_result, c.together)
        << Name(c.model) << " " << c.columns << " " << c.samples;
  }
}

}  // namespace
}  // namespace ballpiston
