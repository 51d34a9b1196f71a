// The folder rules hold in this tree, and each of them can fail.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/layout/include_rules.h"

namespace ballpiston {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Text by path, of all C++ files of the house.
std::map<std::string, std::string> SourceFiles() {
  const std::filesystem::path root = BALLPISTON_SOURCE_DIR;
  std::map<std::string, std::string> files;
  for (const char* folder : {"core", "server", "client", "tests"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".h" && extension != ".cc") continue;
      files[entry.path().lexically_relative(root)] = ReadFile(entry.path());
    }
  }
  return files;
}

// Every target that `program` is linked with, through however many others. Written by CMake.
std::set<std::string> LinkedInto(const std::string& program) {
  std::ifstream file(std::string(BALLPISTON_LINKS_DIR) + "/" + program + ".txt");
  return {std::istream_iterator<std::string>(file), {}};
}

void ExpectWrong(std::string_view path, const std::string& include) {
  EXPECT_THAT(WrongIncludes(path, "#include " + include + "\n"), SizeIs(1)) << path << include;
}

TEST(Layout, EveryIncludePointsTheRightWay) {
  std::string wrong;
  for (const auto& [path, text] : SourceFiles()) {
    for (const std::string& sentence : WrongIncludes(path, text)) wrong += sentence + "\n";
  }
  EXPECT_EQ(wrong, "");
}

TEST(Layout, TheWholeHouseIsRead) {
  const std::map<std::string, std::string> files = SourceFiles();
  EXPECT_TRUE(files.contains("core/geometry/pair_geometry.h"));
  EXPECT_TRUE(files.contains("tests/layout/layout_test.cc"));
  EXPECT_THAT(IncludesOf(files.at("core/geometry/pair_geometry.cc")),
              Contains("core/geometry/pair_geometry.h"));
}

TEST(Layout, EveryTopFolderHasItsMap) {
  for (const char* folder : {"core", "proto", "server", "client", "tests"}) {
    EXPECT_TRUE(
        std::filesystem::exists(std::string(BALLPISTON_SOURCE_DIR) + "/" + folder + "/README.md"))
        << folder;
  }
}

TEST(Layout, TheClientIsLinkedWithNeitherCoreNorServer) {
  const std::set<std::string> linked = LinkedInto("ballpiston");
  EXPECT_THAT(linked, Contains("ballpiston_proto"));
  EXPECT_THAT(linked, Not(Contains("ballpiston_core")));
  EXPECT_THAT(linked, Not(Contains("ballpiston_server")));
}

TEST(Layout, TheCoreIsLinkedWithPhysicsOnly) {
  const std::set<std::string> linked = LinkedInto("ballpiston_core");
  EXPECT_THAT(linked, Contains("Eigen3::Eigen"));
  for (const char* library :
       {"ballpiston_proto", "protobuf::libprotobuf", "gRPC::grpc++", "SQLite::SQLite3"}) {
    EXPECT_THAT(linked, Not(Contains(library)));
  }
}

// The lists of links reach through other targets, or the two tests above would prove nothing.
TEST(Layout, TheServerIsLinkedWithTheCore) {
  EXPECT_THAT(LinkedInto("ballpistond"), Contains("ballpiston_core"));
  EXPECT_THAT(LinkedInto("ballpistond"), Contains("gRPC::grpc++"));
}

TEST(IncludeRules, IncludesAreFoundInOrder) {
  EXPECT_THAT(IncludesOf("#include <vector>\n\n  #  include \"core/a.h\"\n// #include <thread>\n"),
              ElementsAre("vector", "core/a.h"));
}

TEST(IncludeRules, DownwardIncludesAreRight) {
  EXPECT_THAT(WrongIncludes("core/billiard/x.cc",
                            "#include <cmath>\n#include \"core/sampling/direction.h\"\n"
                            "#include \"core/geometry/pair_geometry.h\"\n#include <Eigen/Core>\n"),
              IsEmpty());
  EXPECT_THAT(WrongIncludes("server/jobs/x.cc",
                            "#include <thread>\n#include <sys/stat.h>\n#include <sqlite3.h>\n"
                            "#include \"core/experiment/block_plan.h\"\n"),
              IsEmpty());
}

TEST(IncludeRules, GeometryIncludesNothingAboveIt) {
  ExpectWrong("core/geometry/x.h", "\"core/closed_form/kernel.h\"");
  ExpectWrong("core/geometry/x.h", "\"core/sampling/direction.h\"");
}

TEST(IncludeRules, ClosedFormAndSamplingAreSeparate) {
  ExpectWrong("core/closed_form/x.cc", "\"core/sampling/direction.h\"");
  ExpectWrong("core/sampling/x.cc", "\"core/closed_form/kernel.h\"");
}

TEST(IncludeRules, BilliardIncludesNoExperiment) {
  ExpectWrong("core/billiard/x.h", "\"core/experiment/block_plan.h\"");
  ExpectWrong("core/billiard/x.h", "\"core/statistics/moments.h\"");
}

TEST(IncludeRules, ExperimentsKnowNoComparisonOfMethods) {
  ExpectWrong("core/experiment/x.cc", "\"core/method_comparison/method.h\"");
  EXPECT_THAT(WrongIncludes("core/method_comparison/x.cc",
                            "#include \"core/experiment/return_orbits.h\"\n"
                            "#include \"core/statistics/moments.h\"\n#include <hwy/highway.h>\n"),
              IsEmpty());
}

// Numbers of many bits are for those who compare precisions.
TEST(IncludeRules, BoostIsForTheBilliardOnly) {
  EXPECT_THAT(WrongIncludes("core/billiard/x.h", "#include <boost/multiprecision/eigen.hpp>\n"),
              IsEmpty());
  ExpectWrong("core/experiment/x.h", "<boost/multiprecision/eigen.hpp>");
  ExpectWrong("core/method_comparison/x.h", "<boost/multiprecision/eigen.hpp>");
}

TEST(IncludeRules, StatisticsKnowsNoPhysics) {
  ExpectWrong("core/statistics/x.h", "\"core/geometry/pair_geometry.h\"");
  ExpectWrong("core/statistics/x.h", "\"core/closed_form/kernel.h\"");
}

TEST(IncludeRules, TheCoreKnowsNoServiceAndNoThreads) {
  for (const char* include :
       {"\"ballpiston/v1/result.pb.h\"", "<google/protobuf/message.h>", "<grpcpp/grpcpp.h>",
        "<sqlite3.h>", "\"server/store/store.h\"", "\"client/library/client.h\"", "<thread>",
        "<mutex>", "<unistd.h>", "<CLI/CLI.hpp>"}) {
    ExpectWrong("core/experiment/x.cc", include);
    ExpectWrong("core/geometry/x.cc", include);
  }
}

TEST(IncludeRules, TheClientKnowsTheProtosOnly) {
  for (const char* include :
       {"\"core/geometry/pair_geometry.h\"", "\"server/convert/spec.h\"", "<sqlite3.h>",
        "<Eigen/Core>", "<Random123/philox.h>", "\"tests/layout/include_rules.h\""}) {
    ExpectWrong("client/command/x.cc", include);
  }
}

TEST(IncludeRules, TheServerKnowsNoClient) {
  ExpectWrong("server/api/x.cc", "\"client/library/client.h\"");
  ExpectWrong("server/api/x.cc", "\"tests/layout/include_rules.h\"");
}

TEST(IncludeRules, OneFileOfTheServerParsesFlags) {
  EXPECT_THAT(WrongIncludes("server/command_line.cc", "#include <CLI/CLI.hpp>\n"), IsEmpty());
  ExpectWrong("server/command_line.cc", "\"core/experiment/block_plan.h\"");
  for (const char* path : {"server/api/x.cc", "server/command_line.h", "server/main.cc"}) {
    ExpectWrong(path, "<CLI/CLI.hpp>");
  }
}

TEST(IncludeRules, PhysicsAndMessagesMeetInConvertOnly) {
  const std::string both =
      "#include \"core/experiment/ensemble_spec.h\"\n#include \"ballpiston/v1/spec.pb.h\"\n";
  EXPECT_THAT(WrongIncludes("server/jobs/x.cc", both), SizeIs(1));
  EXPECT_THAT(WrongIncludes("server/convert/x.cc", both), IsEmpty());
}

TEST(IncludeRules, TestsOfALayerKnowNoLayerAboveIt) {
  ExpectWrong("tests/core/geometry/x.cc", "\"server/store/store.h\"");
  ExpectWrong("tests/core/geometry/x.cc", "\"ballpiston/v1/spec.pb.h\"");
  ExpectWrong("tests/client/x.cc", "\"core/geometry/pair_geometry.h\"");
}

TEST(IncludeRules, AFolderWithoutARuleIsWrong) {
  EXPECT_THAT(WrongIncludes("core/thermostat/x.cc", ""), SizeIs(1));
}

}  // namespace
}  // namespace ballpiston
