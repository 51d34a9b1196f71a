#include "server/convert/compressed.h"

#define ZLIB_CONST  // zlib does not change its input
#include <zlib.h>

#include <array>

namespace ballpiston::server {

std::string Compressed(const std::string& plain) {
  uLongf size = compressBound(plain.size());
  std::string bytes(size, '\0');
  compress2(reinterpret_cast<Bytef*>(bytes.data()), &size,
            reinterpret_cast<const Bytef*>(plain.data()), plain.size(), Z_BEST_SPEED);
  bytes.resize(size);
  return bytes;
}

std::optional<std::string> Uncompressed(const std::string& bytes) {
  z_stream stream{};
  stream.next_in = reinterpret_cast<const Bytef*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  int code = inflateInit(&stream);
  std::string plain;
  std::array<char, 16384> part;
  while (code == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = part.size();
    code = inflate(&stream, Z_NO_FLUSH);
    plain.append(part.data(), part.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  if (code != Z_STREAM_END || stream.avail_in > 0) return std::nullopt;
  return plain;
}

}  // namespace ballpiston::server
