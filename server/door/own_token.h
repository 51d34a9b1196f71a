// The token of the server's own user over the loopback, where the kernel does not say who connects.
//
// A server that listens there without TLS makes a token at each start and writes it to a file that
// only its user can read. The file's name is the server's address, so the user's clients find it,
// and send it to this address only. Other users of the machine get nothing.
//
//   $XDG_STATE_HOME/ballpiston/tokens/127.0.0.1:50051    (~/.local/state if it is not set)
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {

class OwnToken {
 public:
  // The folder of the files, in the user's state folder.
  static std::string DefaultFolder();

  // Replaces the file that an earlier server left. Creates the folder, with mode 0700.
  // PERMISSION_DENIED if the file cannot be written.
  static absl::StatusOr<OwnToken> Write(const std::string& folder, const std::string& address,
                                        absl::string_view token);

  OwnToken(OwnToken&& other) noexcept;
  OwnToken& operator=(OwnToken&& other) = delete;
  ~OwnToken();  // removes the file

 private:
  explicit OwnToken(std::string path) : path_(std::move(path)) {}

  std::string path_;  // empty: moved from
};

}  // namespace ballpiston::server
