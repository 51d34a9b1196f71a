#include "server/compute/open_point.h"

#include <algorithm>
#include <cmath>

#include "server/convert/fold_record.h"

namespace ballpiston::server {
namespace {

// Seconds of one core of a lease that may not have all the rest of its point.
constexpr double kLeaseOfAPart = 60;
// An attempt elsewhere ends without a result if the machine is lost or the time limit is too short.
// After this many attempts this server computes the chunk.
constexpr int kMostAttemptsElsewhere = 5;

}  // namespace

OpenPoint::OpenPoint(std::shared_ptr<const PointExperiment> experiment)
    : experiment_(std::move(experiment)), fold_(*experiment_) {}

// ---- what was computed before ----

absl::Status OpenPoint::Resume(StoredPoint stored) {
  if (stored.state && stored.state->model == model()) {
    absl::Status checked = CheckFoldState(*experiment_, stored.state->state);
    if (!checked.ok()) return checked;
    ContinueFrom(std::move(stored.state->state));
  } else if (stored.earlier && stored.earlier->model == model() &&
             CanContinueFrom(*experiment_, stored.earlier->state)) {
    ContinueFrom(std::move(stored.earlier->state));
  }
  for (auto& [chunks_model, chunk] : stored.chunks) {
    if (chunks_model != model()) continue;
    absl::Status checked = CheckChunk(*experiment_, chunk);
    if (!checked.ok()) return checked;
    fold_.Add(std::move(chunk));
  }
  return absl::OkStatus();
}

void OpenPoint::ContinueFrom(FoldState state) {
  next_chunk_ = state.chunk;
  fold_.Resume(std::move(state));
}

absl::Status OpenPoint::DropImpossible(std::vector<ChunkResult>& chunks) const {
  absl::Status found;
  std::erase_if(chunks, [&](const ChunkResult& chunk) {
    const absl::Status checked = Check(chunk);
    if (!checked.ok()) found = checked;
    return !checked.ok();
  });
  return found;
}

absl::Status OpenPoint::Check(const ChunkResult& chunk) const {
  const FoldState& state = fold_.state();
  if (chunk.chunk == state.chunk && chunk.result.samples < state.partial.samples) {
    return absl::DataLossError("a chunk has fewer samples than its merged blocks");
  }
  return CheckChunk(*experiment_, chunk);
}

double OpenPoint::ShareOf(uint64_t samples) const {
  return static_cast<double>(samples) / static_cast<double>(experiment_->plan().samples());
}

// ---- leases ----

void OpenPoint::SkipUnneeded() {
  while (next_chunk_ < chunks() && !fold_.Needs(next_chunk_)) ++next_chunk_;
  std::erase_if(returned_, [this](const auto& chunk) { return !fold_.Needs(chunk.first); });
}

std::optional<std::pair<uint64_t, OpenPoint::Attempt>> OpenPoint::NextChunk(
    const Capacity& capacity) const {
  const ChunkPlan& plan = experiment_->plan();
  const auto fits = [&](uint64_t chunk, const Attempt& attempt) {
    if (!fold_.CanStart(chunk)) return false;
    if (capacity.local) return true;
    const double seconds = plan.SecondsFor(static_cast<double>(plan.SamplesIn(chunk)));
    return attempt.number <= kMostAttemptsElsewhere && seconds <= capacity.longest_chunk;
  };
  for (const auto& [chunk, attempt] : returned_) {
    if (fits(chunk, attempt)) return std::pair(chunk, attempt);
  }
  // Beyond the expected end at most an eighth of what is merged, rounded up to whole chunks or
  // stages, because each may be the last.
  const auto merged = static_cast<double>(plan.SamplesBefore(fold_.state().chunk));
  const uint64_t next_end = plan.ChunksFor(1.125 * merged - static_cast<double>(plan.warm_up()));
  const uint64_t expected = std::max(experiment_->expected_chunks(), next_end);
  const uint64_t end = std::isinf(capacity.seconds) ? chunks() : std::min(expected, chunks());
  if (next_chunk_ >= end || !fits(next_chunk_, Attempt())) return std::nullopt;
  return std::pair(next_chunk_, Attempt());
}

void OpenPoint::Take(uint64_t chunk) {
  if (chunk == next_chunk_) {
    ++next_chunk_;
    SkipUnneeded();
  } else {
    returned_.erase(chunk);
  }
}

bool OpenPoint::AwaitsMemory(const Capacity& capacity) const {
  const bool fits = memory.of_one_turn <= capacity.memory;
  return !fits && !fold_.finished() && NextChunk(capacity).has_value();
}

std::optional<Lease> OpenPoint::NextChunks(const Capacity& capacity) {
  if (fold_.finished() || memory.of_one_turn > capacity.memory) return std::nullopt;
  SkipUnneeded();
  const auto first = NextChunk(capacity);
  if (!first) return std::nullopt;
  const ChunkPlan& plan = experiment_->plan();
  Lease lease = {.local = capacity.local};
  lease.attempt = first->second.number;
  lease.crashes = first->second.crashes;
  if (lease.local) lease.memory = memory;
  lease.experiment = experiment_;
  lease.stop = stop();
  lease.ending = ending_.get_token();
  lease.start.chunk = first->first;
  lease.end = first->first;
  const FoldState& state = fold_.state();
  if (lease.end == state.chunk) lease.start = {state.chunk, state.blocks, state.partial};
  const bool takes_the_rest = lease.local && std::isinf(capacity.seconds) &&
                              memory.of_one_turn <= capacity.memory_of_the_rest &&
                              fold_.waiting() == 0 && KnowsAllStarts();
  if (takes_the_rest && lease.end == next_chunk_) {
    lease.groups = state.complete.groups;
    lease.end = next_chunk_ = chunks();
    return lease;
  }
  if (plan.groups() > 0) {
    lease.groups.resize(plan.groups());
    lease.groups[lease.end % plan.groups()] = fold_.StartOf(lease.end);
  }
  const double seconds = std::isinf(capacity.seconds) ? kLeaseOfAPart : capacity.seconds;
  for (auto next = first; next && *next == std::pair(lease.end, first->second);
       next = NextChunk(capacity)) {
    Take(lease.end);
    lease.seconds += plan.SecondsFor(static_cast<double>(plan.SamplesIn(lease.end)));
    ++lease.end;
    // The chunks of other groups can be computed at the same time.
    if (lease.seconds >= seconds || plan.groups() > 0) break;
  }
  return lease;
}

bool OpenPoint::KnowsAllStarts() const {
  return experiment_->plan().groups() == 0 || fold_.state().chunk == next_chunk_;
}

void OpenPoint::Return(uint64_t first, uint64_t end, int attempt, int crashes) {
  for (uint64_t chunk = first; chunk < std::min(end, next_chunk_); ++chunk) {
    if (fold_.Needs(chunk)) returned_[chunk] = {attempt, crashes};
  }
}

double OpenPoint::ExpectedSeconds() const {
  const ChunkPlan& plan = experiment_->plan();
  const auto expected = static_cast<double>(plan.SamplesBefore(experiment_->expected_chunks()));
  return plan.SecondsFor(std::max(expected - static_cast<double>(fold_.PlannedSamples()), 0.0));
}

}  // namespace ballpiston::server
