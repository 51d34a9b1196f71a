// Runs the programs with the tests' arguments and reads their output. Also the preamble of the
// tests in this folder.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <initializer_list>

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

// A server that has started, and clients of it: `ballpiston WORDS... --server ADDRESS`.
class TestServer : public ServerProcess {
 public:
  explicit TestServer(int workers = 2) : TestServer(ServerSetUp{.workers = workers}) {}
  explicit TestServer(ServerSetUp set_up) : ServerProcess(std::move(set_up)) { Start(); }

  ProcessOptions Command(Words words) const;
  ProcessResult Client(Words words, const std::string& input = "") const;
  std::unique_ptr<Process> StartClient(Words words) const;
  // Runs the client with `--format json` and returns its output. The test fails unless the client
  // exits with 0.
  google::protobuf::Struct Json(Words words) const;
  std::string Submit(Words words) const;  // the name that `submit` prints
};

// Parses strict JSON. If the text is not JSON, the test fails and the object is empty.
google::protobuf::Struct ParseJson(const std::string& text);
// The value at these keys and indices: At(json, "points", 0, "model").
const google::protobuf::Value& At(const google::protobuf::Value& value);
template <typename... Rest>
const google::protobuf::Value& At(const google::protobuf::Value& value, const char* key,
                                  Rest... rest);
template <typename... Rest>
const google::protobuf::Value& At(const google::protobuf::Value& value, int index, Rest... rest);
template <typename... Rest>
const google::protobuf::Value& At(const google::protobuf::Struct& object, const char* key,
                                  Rest... rest) {
  static const google::protobuf::Value absent;
  const auto found = object.fields().find(key);
  return found == object.fields().end() ? absent : At(found->second, rest...);
}

inline const google::protobuf::Value& At(const google::protobuf::Value& value) { return value; }
template <typename... Rest>
const google::protobuf::Value& At(const google::protobuf::Value& value, const char* key,
                                  Rest... rest) {
  return At(value.struct_value(), key, rest...);
}
template <typename... Rest>
const google::protobuf::Value& At(const google::protobuf::Value& value, int index, Rest... rest) {
  static const google::protobuf::Value absent;
  if (index >= value.list_value().values_size()) return absent;
  return At(value.list_value().values(index), rest...);
}

int Length(const google::protobuf::Value& list);

// The bytes of "points" in a document of `result --format json`.
std::string PointsOf(const std::string& document);

}  // namespace ballpiston
