// A finished point can be continued with a larger target, to the bits of one long run.
#include "core/ensemble/point_fold.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

struct SampledQuestion {
  const ExperimentKind* experiment;
  Model model;
  PointParameters point;
  std::vector<int64_t> counts;  // of the unit of the experiment's target
};

// Counts that end within a block, within a chunk, at the end of a chunk, and in the first chunk.
std::vector<SampledQuestion> EveryExperimentThatSamples() {
  const PointParameters pair = PaperPoint(0.2), from = PaperPoint(0.2, 0.125),
                        law = PaperPoint(0.2, 0.125, 1);
  const std::vector<int64_t> counts = {700, 5'000, 65'000};
  std::vector<SampledQuestion> asked;
  for (const Model model : {Model::kBilliard, Model::kBilliardReference}) {
    asked.push_back({&kEquilibrium, model, pair, {5'000, 40'000}});
    asked.push_back({&kConditionalMeanFreeTime, model, from, counts});
    asked.push_back({&kFirstHit, model, law, counts});
    asked.push_back({&kEnergyRelaxation, model, pair, {100, 700}});
    asked.push_back({&kMarkovProperty, model, pair, {3'000, 20'000}});
    asked.push_back({&kLyapunov, model, pair, {3'000, 20'000}});
    asked.push_back({&kGasLyapunov, model, PaperGas(&kGasLyapunov, 0.2), {70, 300}});
  }
  for (const Model model : kModelsThatSampleGases) {
    asked.push_back({&kGasEquilibrium, model, PaperGas(&kGasEquilibrium, 0.2), {70, 300}});
    asked.push_back({&kGasConduction, model, PaperGas(&kGasConduction, 0.2), {300, 1'000}});
  }
  asked.push_back({&kEnergyRelaxation, Model::kMarkov, pair, {100, 700}});
  return asked;
}

std::unique_ptr<const PointExperiment> PointOf(const SampledQuestion& asked, const Target& target) {
  return PointExperiment::Create(SpecOf(asked.experiment, asked.point, target, asked.model, 7), 0);
}

Target TargetOf(const SampledQuestion& asked, int64_t count) {
  const bool has_replicas = asked.experiment == &kGasLyapunov;
  return has_replicas ? Target{.samples = count} : Target{.collisions = count};
}

// Computes the rest of the point; `samples` counts the samples that were not in the state.
PointFold Continued(const PointExperiment& point, const std::optional<FoldState>& state,
                    uint64_t& samples) {
  PointFold fold(point);
  PartialChunk start;
  std::vector<GroupState> groups;
  if (state && (state->chunk > 0 || state->blocks > 0)) {
    fold.Resume(*state);
    start = {state->chunk, state->blocks, state->partial};
    groups = state->complete.groups;
  }
  ChunkFold chunks(point.plan(), start, point.plan().chunks(), groups);
  while (!fold.finished()) {
    const Block block = *chunks.NextBlock();
    samples += block.samples;
    for (ChunkResult& chunk : chunks.Add(block, *RunBlock(point, block))) {
      fold.Add(std::move(chunk));
    }
  }
  return fold;
}

class Continuation : public testing::TestWithParam<SampledQuestion> {};

TEST_P(Continuation, AContinuedPointHasTheBitsOfOneLongRun) {
  const SampledQuestion& asked = GetParam();
  std::optional<FoldState> state;
  uint64_t computed = 0;
  for (const int64_t count : asked.counts) {
    const auto point = PointOf(asked, TargetOf(asked, count));
    const PointFold continued = Continued(*point, state, computed);
    uint64_t all = 0;
    const PointFold at_once = Continued(*point, std::nullopt, all);
    EXPECT_EQ(continued.Merged(), at_once.Merged()) << asked.experiment->name << " " << count;
    EXPECT_EQ(continued.state().chunk_digests, at_once.state().chunk_digests);
    state = continued.Continuation();
    ASSERT_TRUE(state);
  }
}

INSTANTIATE_TEST_SUITE_P(OfEveryExperiment, Continuation,
                         testing::ValuesIn(EveryExperimentThatSamples()));

// Of returns, whose blocks are small.
TEST(ContinuationOfSamples, ComputesNoWholeBlockAgain) {
  const SampledQuestion asked = {&kFirstHit, Model::kBilliard, PaperPoint(0.2, 0.125, 1), {}};
  uint64_t first = 0, second = 0;
  const auto shorter = PointOf(asked, TargetOf(asked, 100'000));
  const std::optional<FoldState> state = Continued(*shorter, std::nullopt, first).Continuation();
  const auto longer = PointOf(asked, TargetOf(asked, 300'000));
  Continued(*longer, state, second);
  EXPECT_LE(first + second, 300'000 + shorter->plan().MostInABlock());
}

// A tolerance that an earlier chunk has reached would have ended the run there.
TEST(ContinuationOfSamples, TheStateKnowsTheLeastErrorBeforeItsLastChunk) {
  const SampledQuestion asked = {
      &kConditionalMeanFreeTime, Model::kBilliard, PaperPoint(0.2, 0.125), {}};
  uint64_t computed = 0;
  const auto tolerant = PointOf(asked, {.tolerance = 0.01});
  const PointFold fold = Continued(*tolerant, std::nullopt, computed);
  const double error = RelativeError(tolerant->FirstEstimate(fold.Merged()));
  EXPECT_LE(error, 0.01);
  EXPECT_GT(fold.Continuation()->least_error, 0.01);

  const auto exact = PointOf(asked, {.tolerance = error / 3});
  const PointFold continued = Continued(*exact, fold.Continuation(), computed);
  uint64_t all = 0;
  EXPECT_EQ(continued.Merged(), Continued(*exact, std::nullopt, all).Merged());
  EXPECT_EQ(computed, all);
}

}  // namespace
}  // namespace ballpiston
