#include "client/library/own_token.h"

#include <unistd.h>

#include <climits>
#include <fstream>

#include "client/library/local_server.h"

namespace ballpiston::client {

std::string OwnToken(const std::string& address) {
  char machine[HOST_NAME_MAX + 1] = {};
  gethostname(machine, HOST_NAME_MAX);
  std::string token;
  std::ifstream(StateFolder() + "/tokens/" + machine + "/" + address) >> token;
  return token;
}

}  // namespace ballpiston::client
