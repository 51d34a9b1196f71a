// The token that a server on the loopback makes for its own user at each start. The server keeps it
// in a file that only this user can read, whose name is the server's address, in a folder for each
// machine that shares the user's home folder:
//
//   $XDG_STATE_HOME/ballpiston/tokens/MACHINE/127.0.0.1:50051    (~/.local/state if it is not set)
#pragma once

#include <string>

namespace ballpiston::client {

// Empty if no server of this user listens at `address`. Reads the file.
std::string OwnToken(const std::string& address);

}  // namespace ballpiston::client
