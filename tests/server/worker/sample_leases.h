// Leases for tests of the worker: of every experiment, by every model that samples.
#pragma once

#include "core/ensemble/ensemble_spec.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "server/worker/lease_file.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

inline constexpr int64_t kSomeSamples = 2000;

// One point of the experiment.
EnsembleSpec SpecOf(const ExperimentKind& kind, Model model, int64_t samples = kSomeSamples);

// One of each experiment and sampling model, of several chunks.
std::vector<EnsembleSpec> EverySampledSpec();

// Chunks first ... end - 1 of the spec's point; end 0 means all.
Lease LeaseOf(const EnsembleSpec& spec, uint64_t first = 0, uint64_t end = 0);

// The record of the lease, from some server.
storage::Lease RecordOf(const Lease& lease, double touch_seconds = 20);

// The chunks of a lease in order, as a worker computes them: block by block, after the blocks of
// the first chunk that the lease already has.
std::vector<ChunkResult> ComputedChunks(const Lease& lease);

// All reports in the file of a lease, merged into one.
LeaseReport ReportsIn(absl::string_view file);

// Whether these are the same chunks, bit for bit.
bool AreEqual(const std::vector<ChunkResult>& a, const std::vector<ChunkResult>& b);

}  // namespace ballpiston::server
