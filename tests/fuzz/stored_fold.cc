// A checkpoint's record: read, checked against each experiment and, if it fits, resumed and
// summarized.
#include <memory>

#include "ballpiston/storage/records.pb.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "core/gas/gas_shape.h"
#include "server/convert/fold_record.h"
#include "server/convert/point_result.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

using Experiments = std::vector<std::unique_ptr<const PointExperiment>>;

// One of each shape of block; both signs of the piston's velocity, and one.
Experiments OneOfEach() {
  const Grid pair = {{kRho, {0.53}}, {kDelta, {0.1}}};
  Grid energy = pair, hit = pair, fast = pair;
  energy[kEpsilon] = {0.125};
  hit[kEpsilon] = {0.125};
  hit[kExponent] = {1};
  fast[kEpsilon] = {0.375};
  fast[kExponent] = {5};
  Grid periodic = pair, conducting = pair;
  periodic[kCells] = conducting[kCells] = {CodeOf({.columns = 4})};
  periodic[kTemperature] = {2};
  conducting[kHot] = {2};
  conducting[kCold] = {1};
  const Target samples = {.samples = 1000}, collisions = {.collisions = 1000};
  Experiments experiments;
  for (const EnsembleSpec& spec : std::vector<EnsembleSpec>{
           {.experiment = &kEquilibrium, .grid = pair, .target = collisions},
           {.experiment = &kConditionalMeanFreeTime, .grid = energy, .target = samples},
           {.experiment = &kFirstHit, .grid = hit, .target = samples},
           {.experiment = &kFirstHit, .grid = fast, .target = samples},
           {.experiment = &kEnergyRelaxation, .grid = pair, .target = samples},
           {.experiment = &kMarkovProperty, .grid = pair, .target = collisions},
           {.experiment = &kGasEquilibrium, .grid = periodic, .target = samples},
           {.experiment = &kGasConduction, .grid = conducting, .target = samples}}) {
    experiments.push_back(PointExperiment::Create(spec, 0));
  }
  return experiments;
}

const Experiments& Known() {
  static const auto* const experiments = new Experiments(OneOfEach());
  return *experiments;
}

void RequireResumed(const PointExperiment& experiment, const FoldState& state) {
  PointFold fold(experiment);
  fold.Resume(state);
  Require(fold.PlannedSamples() <= experiment.plan().samples(), "not more than was planned");
  if (!fold.HasBlocks()) return;
  const BlockResult merged = fold.Merged();
  Require(merged.samples == state.complete.samples + state.partial.samples, "no sample is lost");
  Require(merged.HasShapeOf(experiment.EmptyResult()), "merging keeps the shape");
  const v1::PointResult result = server::ResultOf(3, experiment, experiment.Summarize(merged));
  Require(server::ResultFromBytes(result.SerializeAsString()).ok(),
          "what was merged can be stored");
}

void RequireStored(const FoldState& state) {
  const std::string stored = server::FoldRecordBytes(state);
  const absl::StatusOr<FoldState> again = server::FoldStateFromBytes(stored);
  Require(again.ok() && server::FoldRecordBytes(*again) == stored, "stored bytes come back");
}

void CheckStoredFold(const std::string& bytes) {
  const absl::StatusOr<FoldState> state = server::FoldStateFromBytes(bytes);
  if (!state.ok()) return Require(absl::IsDataLoss(state.status()), "damage is DATA_LOSS");
  if (IsOneIn(4, bytes)) RequireStored(*state);
  for (const auto& experiment : Known()) {
    const absl::Status fits = server::CheckFoldState(*experiment, *state);
    Require(fits.ok() || absl::IsDataLoss(fits), "damage is DATA_LOSS");
    if (fits.ok()) RequireResumed(*experiment, *state);
  }
}

std::vector<std::string> FoldsOfEach() {
  std::vector<std::string> folds;
  for (const auto& experiment : Known()) {
    folds.push_back(server::FoldRecordBytes({.blocks = 1, .partial = experiment->EmptyResult()}));
  }
  return folds;
}

const Registration kStoredFold({.name = "stored_fold",
                                .check = CheckStoredFold,
                                .message = &storage::Checkpoint::default_instance(),
                                .made_seeds = FoldsOfEach});

}  // namespace
}  // namespace ballpiston::fuzz
