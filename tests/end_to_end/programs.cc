#include "tests/end_to_end/programs.h"

#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <utility>

namespace ballpiston {

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "ballpiston_XXXXXX").string();
  path_ = mkdtemp(pattern.data());
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::map<std::string, std::string> CleanEnvironment(const TemporaryFolder& home) {
  return {{"HOME", home.path().string()}, {"XDG_STATE_HOME", ""},
          {"BALLPISTON_SERVER", ""},      {"BALLPISTON_CA", ""},
          {"BALLPISTON_CERT", ""},        {"BALLPISTON_KEY", ""},
          {"BALLPISTON_TLS", ""},         {"BALLPISTON_TOKEN", ""},
          {"BALLPISTON_TOKEN_FILE", ""},  {"BALLPISTON_SERVER_PROGRAM", ""}};
}

ProcessOptions ServerCommand(const TemporaryFolder& home, std::vector<std::string> flags) {
  flags.insert(flags.begin(), BALLPISTON_SERVER_BINARY);
  return {.command = std::move(flags), .environment = CleanEnvironment(home), .input = ""};
}

void TestServer::Start() {
  process_ = std::make_unique<Process>(ServerCommand(
      folder_,
      {"--listen", Address(), "--data-dir", DataDir(), "--workers", std::to_string(workers_)}));
  if (!process_->WaitForErr("listening on")) {
    ADD_FAILURE() << "the server did not start: " << process_->Wait().err;
  }
}

void TestServer::KillHard() {
  process_->Signal(SIGKILL);
  process_->Wait();
}

ProcessResult TestServer::Stop() {
  process_->Signal(SIGTERM);
  return process_->Wait();
}

ProcessOptions TestServer::ClientOptions(std::vector<std::string> words) const {
  words.insert(words.begin(), BALLPISTON_CLIENT_BINARY);
  words.insert(words.end(), {"--server", Address()});
  return {.command = std::move(words), .environment = CleanEnvironment(folder_), .input = ""};
}

ProcessResult TestServer::Client(std::vector<std::string> words, const std::string& input) const {
  ProcessOptions options = ClientOptions(std::move(words));
  options.input = input;
  return RunProgram(options);
}

std::unique_ptr<Process> TestServer::StartClient(std::vector<std::string> words) const {
  return std::make_unique<Process>(ClientOptions(std::move(words)));
}

std::string TestServer::Submit(std::vector<std::string> words) const {
  words.insert(words.begin(), "submit");
  const ProcessResult result = Client(std::move(words));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(result.out.empty());
  return result.out.substr(0, result.out.find('\n'));
}

google::protobuf::Struct ParseJson(const std::string& text) {
  google::protobuf::Struct object;
  const auto status = google::protobuf::util::JsonStringToMessage(text, &object);
  EXPECT_TRUE(status.ok()) << status.ToString() << "\n" << text.substr(0, 500);
  return object;
}

std::string PointsOf(const std::string& document) {
  const size_t begin = document.find("\"points\": [");
  EXPECT_NE(begin, std::string::npos) << document.substr(0, 500);
  return begin == std::string::npos ? "" : document.substr(begin);
}

}  // namespace ballpiston
