#include "server/worker/checked_file.h"

#include <algorithm>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace ballpiston::server {
namespace {

// The first byte is not text, and the line ends show a transfer that changed them.
constexpr absl::string_view kMagic("\211BPW\r\n\032\n", 8);
constexpr size_t kVersionAt = 8, kLengthAt = 12, kHeader = 20, kChecksum = 16;
static_assert(kHeader + kChecksum == kFrameBytes);

void Append(uint64_t number, size_t bytes, std::string& text) {
  for (size_t i = 0; i < bytes; ++i) text.push_back(static_cast<char>(number >> (8 * i) & 0xff));
}

uint64_t NumberAt(absl::string_view text, size_t at, size_t bytes) {
  uint64_t number = 0;
  for (size_t i = bytes; i-- > 0;) number = number << 8 | static_cast<unsigned char>(text[at + i]);
  return number;
}

std::string ChecksumOf(absl::string_view text) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits(text.data(), text.size()));
  return {reinterpret_cast<const char*>(canonical.digest), kChecksum};
}

absl::Status CheckBeginning(absl::string_view file) {
  const size_t known = std::min(file.size(), kMagic.size());
  if (file.substr(0, known) != kMagic.substr(0, known)) {
    return absl::InvalidArgumentError("is not a file of ballpiston");
  }
  if (file.size() < kFrameBytes) {
    return absl::OutOfRangeError(absl::StrCat("is truncated: it has only ", file.size(), " bytes"));
  }
  const uint64_t version = NumberAt(file, kVersionAt, 4);
  if (version == kFormatVersion) return absl::OkStatus();
  return absl::UnimplementedError(absl::StrCat("has format version ", version,
                                               "; this program knows version ", kFormatVersion));
}

}  // namespace

std::string FrameOf(absl::string_view payload) {
  std::string file(kMagic);
  file.reserve(payload.size() + kFrameBytes);
  Append(kFormatVersion, 4, file);
  Append(payload.size(), 8, file);
  file.append(payload.data(), payload.size());
  return file + ChecksumOf(file);
}

absl::StatusOr<absl::string_view> TakeFrame(absl::string_view& bytes) {
  const absl::Status checked = CheckBeginning(bytes);
  if (!checked.ok()) return checked;
  const uint64_t length = NumberAt(bytes, kLengthAt, 8), has = bytes.size() - kFrameBytes;
  if (length > has) {
    return absl::OutOfRangeError(
        absl::StrCat("is truncated: it has ", has, " of ", length, " bytes of payload"));
  }
  const absl::string_view hashed = bytes.substr(0, kHeader + length);
  if (ChecksumOf(hashed) != bytes.substr(hashed.size(), kChecksum)) {
    return absl::DataLossError("is corrupted: its checksum is wrong");
  }
  bytes.remove_prefix(kFrameBytes + length);
  return hashed.substr(kHeader);
}

}  // namespace ballpiston::server
