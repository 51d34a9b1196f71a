#include "client/library/request_id.h"

#include <cstdint>
#include <random>

#include "absl/strings/str_format.h"

namespace ballpiston::client {
namespace {

uint64_t Random64() {
  std::random_device device;
  return (uint64_t{device()} << 32) | device();
}

// The hash FNV-1a, 64 bits. Another basis gives another hash.
uint64_t Fnv1a(absl::string_view text, uint64_t basis) {
  for (const char c : text) basis = (basis ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return basis;
}

std::string Uuid(uint64_t high, uint64_t low, uint64_t version) {
  high = (high & ~uint64_t{0xf000}) | version << 12;
  low = (low & ~(uint64_t{3} << 62)) | uint64_t{2} << 62;  // variant 1
  return absl::StrFormat("%08x-%04x-%04x-%04x-%012x", high >> 32, (high >> 16) & 0xffff,
                         high & 0xffff, low >> 48, low & 0xffffffffffff);
}

}  // namespace

std::string NewRequestId() { return Uuid(Random64(), Random64(), 4); }

std::string RequestIdFor(absl::string_view text) {
  constexpr uint64_t kUsualBasis = 0xcbf29ce484222325, kOtherBasis = 0x9e3779b97f4a7c15;
  return Uuid(Fnv1a(text, kUsualBasis), Fnv1a(text, kOtherBasis), 8);
}

}  // namespace ballpiston::client
