// A server of a test's own, and clients that talk to it.
#ifndef BALLPISTON_TESTS_END_TO_END_PROGRAMS_H_
#define BALLPISTON_TESTS_END_TO_END_PROGRAMS_H_

#include <google/protobuf/struct.pb.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston {

// A home of its own, so that nothing of the user's is touched, and no server from outside.
std::map<std::string, std::string> CleanEnvironment(const TemporaryFolder& home);

class TestServer {
 public:
  explicit TestServer(int workers = 2) : workers_(workers) { Start(); }

  void Start();  // returns when it listens
  void KillHard();
  ProcessResult Stop();  // SIGTERM

  std::string Address() const { return "unix:" + folder_.File("socket"); }
  std::string DataDir() const { return folder_.File("data"); }
  const TemporaryFolder& folder() const { return folder_; }

  // `ballpiston WORDS... --server ADDRESS`
  ProcessResult Client(std::vector<std::string> words, const std::string& input = "") const;
  std::unique_ptr<Process> StartClient(std::vector<std::string> words) const;
  // The name `submit` prints.
  std::string Submit(std::vector<std::string> words) const;

 private:
  ProcessOptions ClientOptions(std::vector<std::string> words) const;

  TemporaryFolder folder_;
  int workers_;
  std::unique_ptr<Process> process_;
};

ProcessOptions ServerCommand(const TemporaryFolder& home, std::vector<std::string> flags);

// Strict JSON; a test failure, and an empty object, if it is not.
google::protobuf::Struct ParseJson(const std::string& text);
// By keys and indices: At(json, "points", 0, "model").
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

// The bytes of "points" in a document of `result --format json`.
std::string PointsOf(const std::string& document);

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_END_TO_END_PROGRAMS_H_
