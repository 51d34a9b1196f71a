// Leases for tests: of every experiment, by every model that samples.
#pragma once

#include "core/ensemble/point_fold.h"
#include "server/convert/fold_record.h"
#include "server/worker/lease_file.h"
#include "tests/core/asked.h"

namespace ballpiston::server {

// One point of the experiment.
inline EnsembleSpec SpecOf(const ExperimentKind& kind, Model model, int64_t samples = 2000) {
  EnsembleSpec spec = OnePointOf(&kind);
  // Exchanges are more frequent, so a replica is less work.
  if (IsOfAGas(&kind)) spec.grid[kDelta] = {0.19};
  spec.target.samples = samples;
  spec.seed = ~uint64_t{0};
  spec.model = model;
  return spec;
}

// One specification for each experiment and sampling model, with several chunks. A sample of a gas
// is more work than other samples, and the first chunk has 64 replicas. An experiment whose samples
// continue each other has 256 trajectories in three stages.
inline std::vector<EnsembleSpec> EverySampledSpec() {
  std::vector<EnsembleSpec> specs;
  for (const ExperimentKind* kind : AllExperiments()) {
    const int64_t samples = kind == &kGasConduction ? 600 : IsOfAGas(kind) ? 66 : 2000;
    for (const Model model : kind->models()) {
      if (TakesSamples(model)) specs.push_back(SpecOf(*kind, model, samples));
    }
  }
  return specs;
}

// Chunks first ... end - 1 of the spec's point; end 0 means all.
inline Lease LeaseOf(const EnsembleSpec& spec, uint64_t first = 0, uint64_t end = 0) {
  Lease lease = {.run = 12, .generation = 3};
  lease.spec = std::make_shared<const EnsembleSpec>(spec);
  lease.experiment = PointExperiment::Create(spec, 0);
  lease.point = 5;
  lease.start.chunk = first;
  lease.end = end == 0 ? lease.experiment->plan().chunks() : end;
  return lease;
}

// The bytes of the lease's file, from some server.
inline std::string FileOf(const Lease& lease, double touch_seconds = 20) {
  return BytesOf(LeaseRecord(lease, "a server", touch_seconds));
}

// The chunks of a lease in order, as a worker computes them: block by block, after the blocks of
// the first chunk that the lease already has.
inline std::vector<ChunkResult> ComputedChunks(const Lease& lease) {
  ChunkFold fold(lease.experiment->plan(), lease.start, lease.end, lease.groups);
  std::vector<ChunkResult> chunks;
  while (const std::optional<Block> block = fold.NextBlock()) {
    for (ChunkResult& chunk : fold.Add(*block, RunBlock(*lease.experiment, *block))) {
      chunks.push_back(std::move(chunk));
    }
  }
  return chunks;
}

// All reports in the file of a lease, merged into one.
inline LeaseReport ReportsIn(absl::string_view file) {
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

// Whether these are the same chunks, bit for bit. As records, because -0 == 0.
inline bool AreEqual(const std::vector<ChunkResult>& a, const std::vector<ChunkResult>& b) {
  const auto bytes = [](const ChunkResult& chunk) { return ChunkRecordBytes(chunk); };
  return std::ranges::equal(a, b, {}, bytes, bytes);
}

}  // namespace ballpiston::server
