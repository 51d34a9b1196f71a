#include "tests/end_to_end/programs.h"

namespace ballpiston {

Words Split(const std::string& text) { return absl::StrSplit(text, ' ', absl::SkipEmpty()); }

Words Joined(std::initializer_list<Words> parts) {
  Words all;
  for (const Words& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

ProcessOptions ClientCommand(const TemporaryFolder& home, Words words) {
  words.insert(words.begin(), ClientProgram());
  ProcessOptions options = {.command = std::move(words), .environment = CleanEnvironment(home)};
  options.environment["BALLPISTON_PYTHON"] = BALLPISTON_PYTHON;
  return options;
}

ProcessOptions TestServer::Command(Words words) const {
  return ClientCommand(folder(), Joined({words, {"--server", address()}}));
}

ProcessResult TestServer::Client(Words words) const {
  return RunProgram(Command(std::move(words)));
}

std::string TestServer::Output(const Words& words) const {
  const ProcessResult result = Client(words);
  if (result.exit_code == 0) return result.out;
  throw std::runtime_error(absl::StrCat(testing::PrintToString(words), " exits with ",
                                        result.exit_code, "\n", result.err));
}

std::string TestServer::Submit(const Words& words) const {
  const std::string out = Output(Joined({{"submit"}, words}));
  EXPECT_THAT(out, EndsWith("\n"));
  return out.substr(0, out.find('\n'));
}

std::string PointsOf(const std::string& document) {
  const size_t begin = document.find("\"points\": [");
  EXPECT_NE(begin, std::string::npos) << document.substr(0, 500);
  return begin == std::string::npos ? "" : document.substr(begin);
}

}  // namespace ballpiston
