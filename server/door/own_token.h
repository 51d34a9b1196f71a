// The token of the server's own user over the loopback, where the kernel does not say who connects.
//
// A server that listens there without TLS makes a token at each start and writes it to a file that
// only its user can read. The file's name is the server's address, so the user's clients find it,
// and send it to this address only. Other users of the machine get nothing.
//
//   $XDG_STATE_HOME/ballpiston/tokens/MACHINE/127.0.0.1:50051    (~/.local/state if it is not set)
//
// MACHINE is the machine's name (hostname): several machines may share the user's home folder, and
// a client must not send a token to the same address of another machine. The name distinguishes
// containers of one machine; the boot's identity does not. Restart the server after the name has
// changed.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace ballpiston::server {

class OwnToken {
 public:
  // The folder of this machine's files, in the user's state folder.
  static std::string DefaultFolder();

  OwnToken();  // a new token, in no file
  OwnToken(const OwnToken&) = delete;
  OwnToken& operator=(const OwnToken&) = delete;
  ~OwnToken();  // removes the file, unless a later server has replaced it

  const std::string& token() const { return token_; }

  // Writes the file, instead of the file that an earlier server left. Creates the folder, with mode
  // 0700. PERMISSION_DENIED if the file cannot be written.
  absl::Status Publish(const std::string& folder, const std::string& address);

 private:
  const std::string token_;
  std::string path_;  // of the file; empty: none
};

}  // namespace ballpiston::server
