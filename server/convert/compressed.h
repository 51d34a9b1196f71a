// Compressed bytes of the store. Pure functions.
#pragma once

#include <optional>
#include <string>

namespace ballpiston::server {

std::string Compressed(const std::string& plain);

// Empty unless the bytes are whole, with the right sum at their end. (Protobuf's
// GzipInputStream does not notice that the end is missing.)
std::optional<std::string> Uncompressed(const std::string& bytes);

}  // namespace ballpiston::server
