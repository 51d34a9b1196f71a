// Compressed bytes: in the store, and in the files that the server and its workers exchange.
// Pure functions.
//
// A stream has gzip's format (RFC 1952). It ends with a checksum of the plain bytes, so a file with
// gaps, or a mixture of two files, is accepted with a probability of some 2^-32. The header's time
// and system fields are not checked and are ignored.
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

std::string Compressed(absl::string_view plain);

// Decompresses the first stream, and removes it from `bytes`. After an error `bytes` are unchanged.
// Errors: OUT_OF_RANGE if the end is missing; DATA_LOSS if the stream is corrupted, or if its
// contents are more than `most` bytes. (Protobuf's GzipInputStream does not notice that the end is
// missing.)
absl::StatusOr<std::string> TakeCompressed(absl::string_view& bytes, size_t most);

// Empty unless the bytes are one whole stream.
std::optional<std::string> Uncompressed(absl::string_view bytes);

}  // namespace ballpiston::server
