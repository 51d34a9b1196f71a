// A finished point can be continued with a larger target, to the bits of one long run.
#include "core/ensemble/point_fold.h"
#include "tests/core/asked.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// A question by one model, and growing numbers of its samples or collisions.
struct Growing {
  EnsembleSpec spec;
  std::vector<int64_t> counts;
};

// Counts that end within a block, within a chunk, at the end of a chunk, and in the first chunk.
std::vector<Growing> EveryExperimentThatSamples() {
  const std::vector<int64_t> of_returns = {700, 5'000, 65'000}, of_orbits = {3'000, 20'000};
  std::vector<Growing> asked;
  for (const auto& [question, counts] : std::vector<std::pair<const char*, std::vector<int64_t>>>{
           {"equilibrium delta=0.2", {5'000, 40'000}},
           {"conditional-mean-free-time delta=0.2", of_returns},
           {"first-hit delta=0.2", of_returns},
           {"energy-relaxation delta=0.2", {100, 700}},
           {"markov-property delta=0.2", of_orbits},
           {"lyapunov delta=0.2", of_orbits},
           {"gas-equilibrium delta=0.2", {70, 300}},
           {"gas-conduction delta=0.2", {300, 1'000}},
           {"gas-lyapunov delta=0.2", {70, 300}}}) {
    EnsembleSpec spec = Asked(absl::StrCat(question, " seed=7"));
    for (const Model model : kModelsThatSampleGases) {
      spec.model = model;
      if (spec.experiment->IsAnsweredBy(model)) asked.push_back({spec, counts});
    }
  }
  return asked;
}

std::unique_ptr<const PointExperiment> PointOf(EnsembleSpec spec, const Target& target) {
  spec.target = target;
  return PointExperiment::Create(spec, 0);
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
    for (ChunkResult& chunk : chunks.Add(block, RunBlock(point, block))) {
      fold.Add(std::move(chunk));
    }
  }
  return fold;
}

class Continuation : public testing::TestWithParam<Growing> {};

TEST_P(Continuation, AContinuedPointHasTheBitsOfOneLongRun) {
  const auto& [spec, counts] = GetParam();
  const bool counts_samples = spec.experiment == &kGasLyapunov;  // of many collisions each
  std::optional<FoldState> state;
  uint64_t computed = 0;
  for (const int64_t count : counts) {
    const auto point =
        PointOf(spec, counts_samples ? Target{.samples = count} : Target{.collisions = count});
    const PointFold continued = Continued(*point, state, computed);
    uint64_t all = 0;
    const PointFold at_once = Continued(*point, std::nullopt, all);
    EXPECT_EQ(continued.Merged(), at_once.Merged()) << spec.experiment->name << " " << count;
    state = continued.Continuation();
    ASSERT_TRUE(state);
  }
}

INSTANTIATE_TEST_SUITE_P(OfEveryExperiment, Continuation,
                         testing::ValuesIn(EveryExperimentThatSamples()));

// Of returns, whose blocks are small.
TEST(ContinuationOfSamples, ComputesNoWholeBlockAgain) {
  const EnsembleSpec asked = Asked("first-hit delta=0.2 seed=7 model=billiard");
  uint64_t first = 0, second = 0;
  const auto shorter = PointOf(asked, {.samples = 100'000});
  const std::optional<FoldState> state = Continued(*shorter, std::nullopt, first).Continuation();
  const auto longer = PointOf(asked, {.samples = 300'000});
  Continued(*longer, state, second);
  EXPECT_LE(first + second, 300'000 + shorter->plan().MostInABlock());
}

// A tolerance that an earlier chunk has reached would have ended the run there.
TEST(ContinuationOfSamples, TheStateKnowsTheLeastErrorBeforeItsLastChunk) {
  const EnsembleSpec asked = Asked("conditional-mean-free-time delta=0.2 seed=7 model=billiard");
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
