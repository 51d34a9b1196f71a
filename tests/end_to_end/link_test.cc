// The client is thin: its binary holds nothing of core or server.

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

std::string Output(Words command) {
  const ProcessResult result = RunProgram({.command = std::move(command)});
  EXPECT_THAT(result, ExitsWith(0));
  return result.out;
}

bool IsOfClientOrProto(const std::string& name) {
  return absl::StartsWith(name, "client::") || absl::StartsWith(name, "v1::") ||
         absl::StartsWith(name, "file::");
}

// Symbols that contain a name of the project outside of the client and the protos.
std::vector<std::string> ForeignSymbols(const std::string& binary) {
  const std::string prefix = "ballpiston::";
  std::istringstream symbols(Output({"nm", "--demangle", "--defined-only", binary}));
  std::vector<std::string> found;
  for (std::string line; std::getline(symbols, line);) {
    size_t at = line.find(prefix);
    while (at != std::string::npos && IsOfClientOrProto(line.substr(at + prefix.size(), 8))) {
      at = line.find(prefix, at + 1);
    }
    if (at != std::string::npos) found.push_back(line);
  }
  return found;
}

TEST(ClientBinary, DefinesNothingOfCoreOrServer) {
  EXPECT_THAT(ForeignSymbols(ClientProgram()), ::testing::IsEmpty());
  EXPECT_GT(ForeignSymbols(ServerProgram()).size(), 100u);  // the check can fail
}

TEST(ClientBinary, NeedsNoLibraryOfTheServers) {
  const std::string needed = Output({"readelf", "--dynamic", ClientProgram()});
  EXPECT_THAT(needed, HasSubstr("libgrpc++"));
  EXPECT_THAT(needed, Not(HasSubstr("sqlite")));
  EXPECT_THAT(needed, Not(HasSubstr("libballpiston")));
  EXPECT_THAT(Output({"readelf", "--dynamic", ServerProgram()}), HasSubstr("sqlite"));
}

}  // namespace
}  // namespace ballpiston
