#include "client/output/npy_array.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "absl/strings/str_cat.h"

namespace ballpiston::client {
namespace {

// Little-endian, whatever this machine is.
template <typename Word>
void Append(Word word, std::string& bytes) {
  for (size_t i = 0; i < sizeof(Word); ++i) {
    bytes.push_back(static_cast<char>(word >> (8 * i) & 0xff));
  }
}

// The magic string, the length of the description, and the description, filled up with spaces so
// that the elements begin at a multiple of 64 bytes.
std::string Header(const std::string& type, const std::vector<size_t>& shape) {
  std::string axes;
  for (const size_t length : shape) absl::StrAppend(&axes, length, ",");
  std::string description =
      absl::StrCat("{'descr': '", type, "', 'fortran_order': False, 'shape': (", axes, "), }");
  constexpr size_t kBefore = 10;
  const size_t unfilled = kBefore + description.size() + 1;
  description.append((64 - unfilled % 64) % 64, ' ').push_back('\n');
  std::string bytes("\x93NUMPY\x01\x00", 8);
  Append(static_cast<uint16_t>(description.size()), bytes);
  return bytes + description;
}

}  // namespace

std::string NpyBytes(const std::vector<double>& elements, const std::vector<size_t>& shape) {
  std::string bytes = Header("<f8", shape);
  bytes.reserve(bytes.size() + elements.size() * sizeof(double));
  for (const double x : elements) Append(std::bit_cast<uint64_t>(x), bytes);
  return bytes;
}

std::string NpyBytes(const std::vector<int64_t>& elements, const std::vector<size_t>& shape) {
  std::string bytes = Header("<i8", shape);
  for (const int64_t x : elements) Append(static_cast<uint64_t>(x), bytes);
  return bytes;
}

std::string NpyBytes(const std::vector<std::string>& elements, const std::vector<size_t>& shape) {
  size_t longest = 1;
  for (const std::string& text : elements) longest = std::max(longest, text.size());
  std::string bytes = Header(absl::StrCat("<U", longest), shape);  // 4 bytes a character
  for (const std::string& text : elements) {
    for (size_t i = 0; i < longest; ++i) {
      Append(i < text.size() ? uint32_t{static_cast<unsigned char>(text[i])} : 0, bytes);
    }
  }
  return bytes;
}

}  // namespace ballpiston::client
