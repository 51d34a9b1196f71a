// Results in files: saved in each format, and computed again.
#include <google/protobuf/util/json_util.h>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

class Save : public ::testing::Test {
 protected:
  std::string File(const std::string& name) const { return folder_.path() + "/" + name; }

  TemporaryFolder folder_;
};

TEST_F(Save, AResultInEachFormat) {
  const TestServer server;
  const Words question = Joined({{"run"}, kQuickQuestion});
  for (const char* name : {"a.json", "a.csv", "a.npz"}) {
    const ProcessResult saved = server.Client(Joined({question, {"--save", File(name)}}));
    ASSERT_THAT(saved, ExitsWith(0));
    EXPECT_EQ(saved.out, File(name) + "\n");
  }
  const ProcessResult printed = server.Client(Joined({question, {"--format", "json"}}));
  EXPECT_EQ(PointsOf(Contents(File("a.json"))), PointsOf(printed.out));
  EXPECT_THAT(Contents(File("a.csv")), StartsWith("# ensembleJobs/"));
  EXPECT_THAT(Contents(File("a.npz")), StartsWith("PK"));
}

// The commands with which docs/answers.md verifies a file.
TEST_F(Save, AFilesQuestionGivesTheSamePointsOnAnotherServer) {
  {
    const TestServer server;
    server.Client(Joined({{"run"}, kQuickQuestion, {"--save", File("a.json")}}));
  }
  std::string spec;
  google::protobuf::util::MessageToJsonString(
      At(ParseJson(Contents(File("a.json"))), "job", "spec"), &spec);
  WriteFile(File("spec.json"), spec);
  const TestServer other;
  const ProcessResult again =
      other.Client({"run", "--fresh", "--spec", File("spec.json"), "--save", File("b.json")});
  ASSERT_THAT(again, ExitsWith(0));
  EXPECT_EQ(PointsOf(Contents(File("b.json"))), PointsOf(Contents(File("a.json"))));
}

TEST_F(Save, ArraysNeedThePythonPackage) {
  const TestServer server;
  ProcessOptions run = server.Command(Joined({{"run"}, kQuickQuestion, {"--save", File("a.npz")}}));
  run.environment["BALLPISTON_PYTHON"] = "false";
  const ProcessResult refused = RunProgram(run);
  EXPECT_THAT(refused, ExitsWith(4));
  EXPECT_THAT(refused.err, HasSubstr("install python3-ballpiston and python3-numpy"));
  EXPECT_EQ(Length(At(server.Json({"list"}), "jobs")), 0);
  EXPECT_EQ(NamesIn(folder_.path()), std::vector<std::string>());
}

}  // namespace
}  // namespace ballpiston
