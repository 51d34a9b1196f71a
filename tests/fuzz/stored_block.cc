// A block's record: read, checked against each experiment, and merged and summarized where it fits.
#include <memory>

#include "ballpiston/v1/storage.pb.h"
#include "core/experiment/point_experiment.h"
#include "server/convert/block_record.h"
#include "server/convert/point_result.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

using Experiments = std::vector<std::unique_ptr<const PointExperiment>>;

// One of each shape of block; both signs of the piston's velocity, and one.
Experiments OneOfEach() {
  const Grid pair = {.rho = {0.53}, .delta = {0.1}};
  Grid energy = pair, hit = pair, fast = pair;
  energy.epsilon = {0.125};
  hit.epsilon = {0.125};
  hit.exponent = {1};
  fast.epsilon = {0.375};
  fast.exponent = {5};
  const Target samples = {.samples = 1000}, collisions = {.collisions = 1000};
  Experiments experiments;
  for (const EnsembleSpec& spec : std::vector<EnsembleSpec>{
           {.experiment = Experiment::kEquilibrium, .grid = pair, .target = collisions},
           {.experiment = Experiment::kConditionalMeanFreeTime, .grid = energy, .target = samples},
           {.experiment = Experiment::kFirstHit, .grid = hit, .target = samples},
           {.experiment = Experiment::kFirstHit, .grid = fast, .target = samples},
           {.experiment = Experiment::kEnergyRelaxation, .grid = pair, .target = samples},
           {.experiment = Experiment::kMarkovProperty, .grid = pair, .target = collisions}}) {
    experiments.push_back(PointExperiment::Create(spec, 0));
  }
  return experiments;
}

const Experiments& Known() {
  static const auto* const experiments = new Experiments(OneOfEach());
  return *experiments;
}

void RequireMerged(const PointExperiment& experiment, const BlockResult& block) {
  BlockResult merged;
  merged.Merge(block);
  merged.health = block.health;  // -0 has become 0
  Require(server::BlockRecordBytes(merged) == server::BlockRecordBytes(block),
          "the first block is what is merged");
  merged.Merge(block);
  Require(merged.samples == 2 * block.samples, "no sample is lost");
  Require(merged.HasShapeOf(block), "merging keeps the shape");
  experiment.TargetReached(2, merged);
  const v1::PointResult result =
      server::PointResultOf(3, experiment, merged, server::Details::kIncluded);
  Require(server::PointResultFromBytes(server::PointResultBytes(result)).ok(),
          "what was merged can be told");
}

void RequireStored(const BlockResult& block) {
  const std::string stored = server::BlockRecordBytes(block);
  const absl::StatusOr<BlockResult> again = server::BlockResultFromBytes(stored);
  Require(again.ok() && server::BlockRecordBytes(*again) == stored, "stored bytes come back");
}

void CheckStoredBlock(const std::string& bytes) {
  const absl::StatusOr<BlockResult> block = server::BlockResultFromBytes(bytes);
  if (!block.ok()) return Require(absl::IsDataLoss(block.status()), "damage is DATA_LOSS");
  if (IsOneIn(4, bytes)) RequireStored(*block);
  for (const auto& experiment : Known()) {
    const absl::Status fits = server::CheckBlock(*experiment, 0, *block);
    Require(fits.ok() || absl::IsDataLoss(fits), "damage is DATA_LOSS");
    if (fits.ok()) RequireMerged(*experiment, *block);
  }
}

std::vector<std::string> BlocksOfEach() {
  std::vector<std::string> blocks;
  for (const auto& experiment : Known()) {
    blocks.push_back(server::BlockRecordBytes(experiment->EmptyResult()));
  }
  return blocks;
}

const Registration kStoredBlock({.name = "stored_block",
                                 .check = CheckStoredBlock,
                                 .message = &v1::BlockRecord::default_instance(),
                                 .made_seeds = BlocksOfEach});

}  // namespace
}  // namespace ballpiston::fuzz
