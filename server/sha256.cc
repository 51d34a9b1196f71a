#include "server/sha256.h"

#include <openssl/evp.h>

namespace ballpiston::server {

std::string Sha256(absl::string_view bytes) {
  std::string digest(kSha256Bytes, '\0');
  EVP_Digest(bytes.data(), bytes.size(), reinterpret_cast<unsigned char*>(digest.data()), nullptr,
             EVP_sha256(), nullptr);
  return digest;
}

}  // namespace ballpiston::server
