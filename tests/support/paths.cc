#include "tests/support/paths.h"

namespace ballpiston {

std::string SourcePath(const std::string& relative) {
  return std::string(BALLPISTON_SOURCE_DIR) + "/" + relative;
}

std::string BuildPath(const std::string& relative) {
  return std::string(BALLPISTON_BINARY_DIR) + "/" + relative;
}

std::string ServerProgram() { return BuildPath("bin/ballpistond"); }

std::string ClientProgram() { return BuildPath("bin/ballpiston"); }

}  // namespace ballpiston
