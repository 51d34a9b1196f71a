#include "tests/end_to_end/programs.h"

#include <google/protobuf/util/json_util.h>

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

ProcessResult TestServer::Client(Words words, const std::string& input) const {
  ProcessOptions options = Command(std::move(words));
  options.input = input;
  return RunProgram(options);
}

std::unique_ptr<Process> TestServer::StartClient(Words words) const {
  return std::make_unique<Process>(Command(std::move(words)));
}

google::protobuf::Struct TestServer::Json(Words words) const {
  const ProcessResult result = Client(Joined({words, {"--format", "json"}}));
  EXPECT_THAT(result, ExitsWith(0)) << testing::PrintToString(words);
  return ParseJson(result.out);
}

std::string TestServer::Submit(Words words) const {
  const ProcessResult result = Client(Joined({{"submit"}, words}));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_FALSE(result.out.empty());
  return result.out.substr(0, result.out.find('\n'));
}

google::protobuf::Struct ParseJson(const std::string& text) {
  google::protobuf::Struct object;
  const auto status = google::protobuf::util::JsonStringToMessage(text, &object);
  EXPECT_TRUE(status.ok()) << status.ToString() << "\n" << text.substr(0, 500);
  return object;
}

int Length(const google::protobuf::Value& list) { return list.list_value().values_size(); }

std::string PointsOf(const std::string& document) {
  const size_t begin = document.find("\"points\": [");
  EXPECT_NE(begin, std::string::npos) << document.substr(0, 500);
  return begin == std::string::npos ? "" : document.substr(begin);
}

}  // namespace ballpiston
