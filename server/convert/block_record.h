// Between the core's BlockResult and the record the store keeps of it, exactly. Pure functions.
//
// A record that can be read may still be damaged: before it is merged it has to be one that its
// experiment can have written.
#ifndef BALLPISTON_SERVER_CONVERT_BLOCK_RECORD_H_
#define BALLPISTON_SERVER_CONVERT_BLOCK_RECORD_H_

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/experiment/block_result.h"
#include "core/experiment/point_experiment.h"

namespace ballpiston::server {

std::string BlockRecordBytes(const BlockResult& result);
absl::StatusOr<BlockResult> BlockResultFromBytes(const std::string& bytes);  // DATA_LOSS

// DATA_LOSS unless the block is one of the plan's, with no more samples than planned, an error of
// the energy, the accumulators that merging relies on, and no sample twice in a histogram.
absl::Status CheckBlock(const PointExperiment& experiment, uint64_t block,
                        const BlockResult& result);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_CONVERT_BLOCK_RECORD_H_
