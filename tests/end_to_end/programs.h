// Runs the programs with the tests' arguments and reads their output. Also the preamble of the
// tests in this folder.
#pragma once

#include <google/protobuf/util/json_util.h>

#include <initializer_list>

#include "ballpiston/file/v1/progress.pb.h"
#include "ballpiston/file/v1/saved_result.pb.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/server.pb.h"
#include "tests/support/preamble.h"
#include "tests/support/process.h"
#include "tests/support/server_process.h"

namespace ballpiston {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

Words Split(const std::string& text);  // at spaces
Words Joined(std::initializer_list<Words> parts);

// A question that sampling answers in a moment, and one that takes years.
inline const Words kQuickQuestion = Split(
    "first-hit --rho 0.53 --delta 0.2,0.1 --epsilon 0.1 --exponent 1 --samples 2000 --seed 7");
inline const Words kEndlessQuestion =
    Split("equilibrium --rho 0.53 --delta 0.05 --collisions 1000000000000 --model billiard");

// `ballpiston WORDS...`
ProcessOptions ClientCommand(const TemporaryFolder& home, Words words);

// A figure prints nothing on standard error, but matplotlib may print one line: that it builds its
// list of fonts, which a new home folder does not have.
inline const auto kQuiet =
    testing::MatchesRegex("(Matplotlib is building the font cache[^\n]*\n)?");

// Parses JSON of this message. Throws std::runtime_error if the text is something else.
template <typename Message>
Message FromJson(const std::string& text) {
  Message message;
  const auto status = google::protobuf::util::JsonStringToMessage(text, &message);
  if (status.ok()) return message;
  throw std::runtime_error(status.ToString() + "\n" + text.substr(0, 500));
}

// A server that has started, and clients of it: `ballpiston WORDS... --server ADDRESS`.
class TestServer : public ServerProcess {
 public:
  explicit TestServer(int workers = 2) : TestServer(ServerSetUp{.workers = workers}) {}
  explicit TestServer(ServerSetUp set_up) : ServerProcess(std::move(set_up)) { Start(); }

  ProcessOptions Command(Words words) const;
  ProcessResult Client(Words words) const;
  // The output of the client with `--format json`.
  template <typename Message>
  Message Json(const Words& words) const {
    return FromJson<Message>(Output(Joined({words, {"--format", "json"}})));
  }
  v1::ServerStatus Status() const { return Json<v1::ServerStatus>({"status"}); }
  // All jobs, the newest first, without their grids.
  v1::ListEnsembleJobsResponse List() const { return Json<v1::ListEnsembleJobsResponse>({"list"}); }
  std::string Submit(const Words& words) const;  // the name that `submit` prints

 private:
  // The standard output of `ballpiston WORDS...`. Throws std::runtime_error if the client does not
  // exit with 0.
  std::string Output(const Words& words) const;
};

// The bytes of "points" in a document of `result --format json`.
std::string PointsOf(const std::string& document);

}  // namespace ballpiston
