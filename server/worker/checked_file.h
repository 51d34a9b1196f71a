// Files that the server and its workers exchange in a shared folder. A checksum proves that a file
// is complete.
//
// The format, with little-endian numbers:
//   bytes  0 to  7   the magic "\211BPW\r\n\032\n"
//   bytes  8 to 11   the format version, kFormatVersion
//   bytes 12 to 15   the kind of the file, FileKind
//   bytes 16 to 23   the length of the payload in bytes
//   then             the payload: a message of storage/records.proto
//   the last 16      XXH3 (128 bits, canonical) of all bytes before
//
// Writing is atomic and durable: a temporary name in the same folder, fsync, rename, fsync of the
// folder. A reader sees a whole file or none. Errors name the file. Properties, each with a test of
// its name:
//   1. AChangedByteIsRejected.  2. AShorterFileIsRejected.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {

enum class FileKind : uint32_t { kTasks = 1, kChunks = 2 };

inline constexpr uint32_t kFormatVersion = 1;
inline constexpr size_t kFrameBytes = 40;                    // of a file without payload
inline constexpr size_t kMaxCheckedFile = size_t{64} << 20;  // bytes of a whole file

std::string FrameOf(FileKind kind, absl::string_view payload);

// The payload, a part of `file`. Errors, in the order in which they are found:
//   RESOURCE_EXHAUSTED   larger than kMaxCheckedFile
//   INVALID_ARGUMENT     does not begin with the magic, or is of another kind
//   UNIMPLEMENTED        has another format version
//   OUT_OF_RANGE         truncated
//   DATA_LOSS            corrupted
absl::StatusOr<absl::string_view> PayloadOf(FileKind kind, absl::string_view file);

// Mode 0600. If the file exists already, the result is OK if it has the same bytes, and
// ALREADY_EXISTS if not. RESOURCE_EXHAUSTED if the file is too large, or the disk is full;
// UNAVAILABLE if the folder does not exist or cannot be written.
absl::Status WriteCheckedFile(const std::string& path, FileKind kind, absl::string_view payload);

// The payload. Errors of PayloadOf, and
//   NOT_FOUND            does not exist
//   FAILED_PRECONDITION  a symbolic link, or not a regular file
//   PERMISSION_DENIED    does not belong to the user of this process, or must not be read
//   UNAVAILABLE          cannot be read
absl::StatusOr<std::string> ReadCheckedFile(const std::string& path, FileKind kind);

}  // namespace ballpiston::server
