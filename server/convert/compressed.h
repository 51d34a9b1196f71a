// Compressed bytes: in the store, and in the files that the server and its workers exchange. Pure
// functions.
//
// A stream ends with a checksum of the plain bytes, so damage passes only if the checksum happens
// to be right:
//   kAdler32  zlib's format (RFC 1950), for rows of the store: 4 bytes. Weak for short messages,
//             but SQLite and the disk rarely damage a row.
//   kCrc32    gzip's format (RFC 1952), for files of a network: 8 bytes more. A torn or mixed file
//             passes with a probability of some 2^-32. The time and the system in a stream's first
//             bytes are not checked, and mean nothing.
//
// Properties, each with a test of its name:
//   1. AChangedByteGivesNoOtherBytes.  2. AShorterStreamIsTruncated.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {

enum class Checksum { kAdler32, kCrc32 };

std::string Compressed(absl::string_view plain, Checksum checksum = Checksum::kAdler32);

// Takes the first stream, of either format, off `bytes`, and returns its contents. After an error
// `bytes` are as before. Errors: OUT_OF_RANGE if the end is missing; DATA_LOSS if the stream is
// corrupted, or if its contents are more than `most` bytes. (Protobuf's GzipInputStream does not
// notice that the end is missing.)
absl::StatusOr<std::string> TakeCompressed(absl::string_view& bytes, size_t most);

// Empty unless the bytes are one whole stream.
std::optional<std::string> Uncompressed(absl::string_view bytes);

}  // namespace ballpiston::server
