// Compressed bytes: in the store, and in the files that the server and its workers exchange.
// Pure functions.
//
// A stream ends with a checksum of the plain bytes, so damage is missed only if the checksum agrees
// by chance:
//   kAdler32  zlib's format (RFC 1950), for rows of the store: 4 bytes. Weak for short messages,
//             but SQLite and the disk rarely damage a row.
//   kCrc32    gzip's format (RFC 1952), for files on a network file system: 12 bytes more. A file
//             with gaps, or a mixture of two files, is accepted with a probability of some 2^-32.
//             The header's time and system fields are not checked and are ignored.
//
// Properties, each with a test of its name:
//   1. AChangedByteIsDetectedOrHarmless.  2. AShorterStreamIsTruncated.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {

enum class Checksum { kAdler32, kCrc32 };

std::string Compressed(absl::string_view plain, Checksum checksum = Checksum::kAdler32);

// Decompresses the first stream, of either format, and removes it from `bytes`. After an error
// `bytes` are unchanged. Errors: OUT_OF_RANGE if the end is missing; DATA_LOSS if the stream is
// corrupted, or if its contents are more than `most` bytes. (Protobuf's GzipInputStream does not
// notice that the end is missing.)
absl::StatusOr<std::string> TakeCompressed(absl::string_view& bytes, size_t most);

// Empty unless the bytes are one whole stream.
std::optional<std::string> Uncompressed(absl::string_view bytes);

}  // namespace ballpiston::server
