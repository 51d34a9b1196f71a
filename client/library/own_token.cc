#include "client/library/own_token.h"

#include <fstream>

#include "client/library/local_server.h"

namespace ballpiston::client {

std::string OwnToken(const std::string& address) {
  std::string token;
  std::ifstream(StateFolder() + "/tokens/" + address) >> token;
  return token;
}

}  // namespace ballpiston::client
