#include "server/convert/compressed.h"

#define ZLIB_CONST  // zlib does not change its input
#include <zlib.h>

#include <array>
#include <new>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

// zlib's windowBits: the logarithm of the window size, plus 16 for gzip's format.
constexpr int kWindow = MAX_WBITS + 16;
constexpr int kDefaultMemory = 8;

z_stream StreamFrom(absl::string_view bytes) {
  z_stream stream{};
  stream.next_in = reinterpret_cast<const Bytef*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  return stream;
}

}  // namespace

std::string Compressed(absl::string_view plain) {
  z_stream stream = StreamFrom(plain);
  const int code =
      deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kWindow, kDefaultMemory, Z_DEFAULT_STRATEGY);
  if (code != Z_OK) throw std::bad_alloc();
  std::string bytes(deflateBound(&stream, plain.size()), '\0');
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  deflate(&stream, Z_FINISH);
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

absl::StatusOr<std::string> TakeCompressed(absl::string_view& bytes, size_t most) {
  z_stream stream = StreamFrom(bytes);
  int code = inflateInit2(&stream, kWindow);
  std::string plain;
  std::array<char, 16384> part;
  while (code == Z_OK && plain.size() <= most) {
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = part.size();
    code = inflate(&stream, Z_NO_FLUSH);
    plain.append(part.data(), part.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  if (code == Z_BUF_ERROR) {
    return absl::OutOfRangeError(
        absl::StrCat("is truncated: it has only ", bytes.size(), " bytes"));
  }
  if (plain.size() > most) {
    return absl::DataLossError(absl::StrCat("has more than ", most, " bytes when unpacked"));
  }
  if (code != Z_STREAM_END) {
    return absl::DataLossError("is corrupted, or is not a file of ballpiston");
  }
  bytes.remove_prefix(bytes.size() - stream.avail_in);
  return plain;
}

std::optional<std::string> Uncompressed(absl::string_view bytes) {
  absl::StatusOr<std::string> plain = TakeCompressed(bytes, std::string::npos);
  if (!plain.ok() || !bytes.empty()) return std::nullopt;
  return *std::move(plain);
}

}  // namespace ballpiston::server
