// Exact conversion between the core's accumulators and their records: a point's checkpoint, a
// chunk. Pure functions.
//
// A record that can be parsed may still be damaged. So before a point is resumed, CheckFoldState
// checks that the record is possible for the point's experiment.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ballpiston/storage/records.pb.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"

namespace ballpiston::server {

struct StoredState {
  Model model = Model::kAuto;  // that computed it
  FoldState state;
};

struct StoredChunk {
  Model model = Model::kAuto;
  ChunkResult chunk;
};

void FillAccumulators(const BlockResult& result, storage::Accumulators& record);
void FillGroup(const GroupState& group, storage::Group& record);
GroupState GroupOf(const storage::Group& record);
BlockResult ResultOfAccumulators(const storage::Accumulators& record);
void FillChunk(const ChunkResult& chunk, storage::Chunk& record);
ChunkResult ChunkOf(const storage::Chunk& record);

std::string FoldRecordBytes(const FoldState& state, Model model = Model::kAuto);
absl::StatusOr<FoldState> FoldStateFromBytes(const std::string& bytes);     // DATA_LOSS
absl::StatusOr<StoredState> CheckpointFromBytes(const std::string& bytes);  // DATA_LOSS

// The final state of a finished point, compressed. Another job can continue from it.
std::string EndBytes(const FoldState& state);
absl::StatusOr<FoldState> EndFromBytes(const std::string& bytes);  // DATA_LOSS

std::string ChunkRecordBytes(const ChunkResult& chunk, Model model = Model::kAuto);
absl::StatusOr<StoredChunk> ChunkFromBytes(const std::string& bytes);  // DATA_LOSS

// DATA_LOSS unless all of this holds: the state lies within the plan, it has at most the planned
// samples, its energy error is valid, it has the accumulators that merging needs, no histogram
// counts a sample twice, and the groups of trajectories can continue.
absl::Status CheckFoldState(const PointExperiment& experiment, const FoldState& state);
// The same for a whole chunk.
absl::Status CheckChunk(const PointExperiment& experiment, const ChunkResult& chunk);

// Whether the experiment can continue from the end of an earlier one, which had another target: the
// state is possible, and the relative error was above the tolerance at all earlier chunks.
bool CanContinueFrom(const PointExperiment& experiment, const FoldState& state);

}  // namespace ballpiston::server
