// Between the core's BlockResult and the record the store keeps of it, exactly. Pure functions.
#ifndef BALLPISTON_SERVER_CONVERT_BLOCK_RECORD_H_
#define BALLPISTON_SERVER_CONVERT_BLOCK_RECORD_H_

#include <string>

#include "absl/status/statusor.h"
#include "core/experiment/block_result.h"

namespace ballpiston::server {

std::string BlockRecordBytes(const BlockResult& result);
absl::StatusOr<BlockResult> BlockResultFromBytes(const std::string& bytes);  // DATA_LOSS

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_CONVERT_BLOCK_RECORD_H_
