// The chunks that a worker appends to a lease's file. The input is used as a whole frame, and as
// the payload of a frame with a correct checksum. Chunks that fit a lease are merged.
#include "server/worker/chunk_file.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ballpiston/storage/records.pb.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "server/worker/checked_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

using Leases = std::vector<server::IdentifiedLease>;

server::IdentifiedLease LeaseOf(const EnsembleSpec& spec) {
  server::Lease lease;
  lease.experiment = PointExperiment::Create(spec, 0);
  lease.end = lease.experiment->plan().chunks();
  return {{}, std::move(lease)};
}

// One with moments and histograms, one with batch means, and one with a tolerance.
const Leases& KnownLeases() {
  const Grid pair = {{kRho, {0.53}}, {kDelta, {0.1}}};
  Grid hit = pair;
  hit[kEpsilon] = {0.125};
  hit[kExponent] = {1};
  static const auto* const leases = new Leases{
      LeaseOf({.experiment = &kMarkovProperty, .grid = pair, .target = {.collisions = 1000}}),
      LeaseOf({.experiment = &kEquilibrium, .grid = pair, .target = {.collisions = 1000}}),
      LeaseOf({.experiment = &kFirstHit, .grid = hit, .target = {.tolerance = 0.1}})};
  return *leases;
}

void RequireMerged(const PointExperiment& experiment, const server::LeaseChunks& chunks) {
  PointFold fold(experiment);
  for (const ChunkResult& chunk : chunks.chunks) fold.Add(chunk);
  Require(fold.PlannedSamples() <= experiment.plan().samples(), "not more than was planned");
}

void CheckLeases(const server::LeaseChunks& chunks) {
  for (const server::IdentifiedLease& lease : KnownLeases()) {
    const absl::Status fits = server::CheckLeaseChunks(lease, chunks);
    Require(fits.ok() || absl::IsDataLoss(fits), "damage is DATA_LOSS");
    if (fits.ok()) RequireMerged(*lease.lease.experiment, chunks);
  }
}

void CheckPayload(absl::string_view payload) {
  const absl::StatusOr<server::LeaseChunks> chunks = server::LeaseChunksFromPayload(payload);
  if (!chunks.ok()) return Require(absl::IsDataLoss(chunks.status()), "damage is DATA_LOSS");
  const std::string written = server::LeaseChunksPayload(*chunks);
  const absl::StatusOr<server::LeaseChunks> again = server::LeaseChunksFromPayload(written);
  Require(again.ok() && server::LeaseChunksPayload(*again) == written, "written bytes come back");
  CheckLeases(*chunks);
}

void CheckChunkFile(const std::string& input) {
  absl::string_view bytes = input;
  const auto payload = server::TakeFrame(server::FrameKind::kChunks, bytes);
  if (payload.ok()) CheckPayload(*payload);
  const std::string frame = server::FrameOf(server::FrameKind::kChunks, input);
  bytes = frame;
  const auto framed = server::TakeFrame(server::FrameKind::kChunks, bytes);
  Require(framed.ok() && *framed == input && bytes.empty(), "a payload comes back");
  CheckPayload(input);
}

std::vector<std::string> FilesOfEach() {
  std::vector<std::string> files;
  for (const server::IdentifiedLease& lease : KnownLeases()) {
    const std::string payload = server::LeaseChunksPayload(
        {.chunks = {{0, lease.lease.experiment->EmptyResult()}}, .processor_seconds = 0.5});
    files.push_back(payload);
    files.push_back(server::FrameOf(server::FrameKind::kChunks, payload));
  }
  return files;
}

const Registration kChunkFile({.name = "chunk_file",
                               .check = CheckChunkFile,
                               .message = &storage::LeaseChunks::default_instance(),
                               .made_seeds = FilesOfEach});

}  // namespace
}  // namespace ballpiston::fuzz
