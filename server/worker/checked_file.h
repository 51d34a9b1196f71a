// The frames of the files that the server and its workers exchange in a shared folder. A checksum
// proves that a frame is complete. A file is a sequence of frames, so it can grow.
//
// The format of a frame, with little-endian numbers:
//   bytes  0 to  7   the magic "\211BPW\r\n\032\n"
//   bytes  8 to 11   the format version, kFormatVersion
//   bytes 12 to 19   the length of the payload in bytes
//   then             the payload: a message of storage/records.proto
//   the last 16      XXH3 (128 bits, canonical) of all bytes before
//
// Pure functions. Properties, each with a test of its name:
//   1. AChangedByteIsRejected.  2. AShorterFileIsRejected.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {

inline constexpr uint32_t kFormatVersion = 1;
inline constexpr size_t kFrameBytes = 36;                    // of a frame without payload
inline constexpr size_t kMaxCheckedFile = size_t{64} << 20;  // bytes of a whole file

std::string FrameOf(absl::string_view payload);

// The payload of the first frame, and `bytes` without this frame. After an error `bytes` are as
// before. Errors, in the order in which they are found:
//   INVALID_ARGUMENT     does not begin with the magic
//   UNIMPLEMENTED        has another format version
//   OUT_OF_RANGE         truncated
//   DATA_LOSS            corrupted
absl::StatusOr<absl::string_view> TakeFrame(absl::string_view& bytes);

}  // namespace ballpiston::server
