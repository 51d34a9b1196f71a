#include "tests/server/worker/sample_leases.h"

#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "core/gas/gas_shape.h"
#include "server/convert/fold_record.h"

namespace ballpiston::server {
namespace {

double SomeValueOf(const Parameter& parameter) {
  if (&parameter == &kRho) return 0.53;
  if (&parameter == &kDelta) return 0.1;
  if (&parameter == &kEpsilon) return 0.25;
  if (&parameter == &kCells) return CodeOf({.columns = 2});
  if (&parameter == &kCold) return 4;
  return &parameter == &kExponent ? 1 : 8;
}

bool Samples(Model model) { return model != Model::kClosedForm && model != Model::kSpectrum; }

bool IsGas(const ExperimentKind& kind) {
  return &kind == &kGasEquilibrium || &kind == &kGasConduction || &kind == &kGasLyapunov;
}

// A sample of a gas is more work than other samples. The first chunk has 64 replicas. Of samples
// that continue each other there are 256 trajectories, and three stages.
int64_t SamplesOf(const ExperimentKind& kind) {
  if (&kind == &kGasConduction) return 600;
  return IsGas(kind) ? 66 : kSomeSamples;
}

}  // namespace

EnsembleSpec SpecOf(const ExperimentKind& kind, Model model, int64_t samples) {
  EnsembleSpec spec = {.experiment = &kind, .seed = ~uint64_t{0}, .model = model};
  for (const ParameterUse& use : kind.parameters) {
    spec.grid[*use.parameter] = {SomeValueOf(*use.parameter)};
  }
  // Exchanges are more frequent, so a replica is less work.
  if (IsGas(kind)) spec.grid[kDelta] = {0.19};
  spec.target.samples = samples;
  return spec;
}

std::vector<EnsembleSpec> EverySampledSpec() {
  std::vector<EnsembleSpec> specs;
  for (const ExperimentKind* kind : AllExperiments()) {
    for (const Model model : kind->models()) {
      if (Samples(model)) specs.push_back(SpecOf(*kind, model, SamplesOf(*kind)));
    }
  }
  return specs;
}

Lease LeaseOf(const EnsembleSpec& spec, uint64_t first, uint64_t end) {
  Lease lease = {.run = 12, .generation = 3};
  lease.spec = std::make_shared<const EnsembleSpec>(spec);
  lease.experiment = PointExperiment::Create(spec, 0);
  lease.point = 5;
  lease.start.chunk = first;
  lease.end = end == 0 ? lease.experiment->plan().chunks() : end;
  return lease;
}

storage::Lease RecordOf(const Lease& lease, double touch_seconds) {
  return LeaseRecord(lease, "a server", touch_seconds);
}

std::vector<ChunkResult> ComputedChunks(const Lease& lease) {
  ChunkFold fold(lease.experiment->plan(), lease.start, lease.end, lease.groups);
  std::vector<ChunkResult> chunks;
  while (const std::optional<Block> block = fold.NextBlock()) {
    for (ChunkResult& chunk : fold.Add(*block, RunBlock(*lease.experiment, *block))) {
      chunks.push_back(std::move(chunk));
    }
  }
  return chunks;
}

LeaseReport ReportsIn(absl::string_view file) {
  EXPECT_OK(TakeLease(file));
  LeaseReport all;
  while (!file.empty()) {
    const absl::StatusOr<LeaseReport> report = TakeReport(file);
    EXPECT_OK(report);
    if (!report.ok()) break;
    all.chunks.insert(all.chunks.end(), report->chunks.begin(), report->chunks.end());
    all.seconds += report->seconds;
  }
  return all;
}

// As records, because -0 == 0.
bool AreEqual(const std::vector<ChunkResult>& a, const std::vector<ChunkResult>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const ChunkResult& x, const ChunkResult& y) {
                      return ChunkRecordBytes(x) == ChunkRecordBytes(y);
                    });
}

}  // namespace ballpiston::server
