// Tests that the folder rules hold in this tree, and that each rule can fail.
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
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

// Text by path, of all C++ files of the project.
std::map<std::string, std::string> SourceFiles() {
  const std::filesystem::path root = SourcePath("");
  std::map<std::string, std::string> files;
  for (const char* folder : {"core", "server", "client", "tests", "tools"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".h" && extension != ".cc") continue;
      files[entry.path().lexically_relative(root)] = Contents(entry.path());
    }
  }
  return files;
}

// Every target that `program` is linked with, through however many others. Written by CMake.
std::set<std::string> LinkedInto(const std::string& program) {
  std::ifstream file(BuildPath("tests/layout/links/" + program + ".txt"));
  return {std::istream_iterator<std::string>(file), {}};
}

void ExpectWrong(std::string_view path, const std::string& include) {
  EXPECT_THAT(WrongIncludes(path, "#include " + include + "\n"), SizeIs(1)) << path << include;
}

TEST(Layout, EveryIncludeIsAllowed) {
  std::string wrong;
  for (const auto& [path, text] : SourceFiles()) {
    for (const std::string& sentence : WrongIncludes(path, text)) wrong += sentence + "\n";
  }
  EXPECT_EQ(wrong, "");
}

TEST(Layout, SourcesOfAllFoldersAreRead) {
  const std::map<std::string, std::string> files = SourceFiles();
  EXPECT_TRUE(files.contains("core/geometry/pair_geometry.h"));
  EXPECT_TRUE(files.contains("tests/layout/layout_test.cc"));
  EXPECT_TRUE(files.contains("tools/stability/main.cc"));
  EXPECT_THAT(IncludesOf(files.at("core/geometry/pair_geometry.cc")),
              Contains("core/geometry/pair_geometry.h"));
}

TEST(Layout, EveryTopFolderHasAReadme) {
  for (const std::string folder : {"core", "proto", "server", "client", "tests", "tools"}) {
    EXPECT_TRUE(std::filesystem::exists(SourcePath(folder + "/README.md"))) << folder;
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

// The lists of links must include indirect ones, or the two tests above would prove nothing.
TEST(Layout, TheServerIsLinkedWithTheCore) {
  EXPECT_THAT(LinkedInto("ballpistond"), Contains("ballpiston_core"));
  EXPECT_THAT(LinkedInto("ballpistond"), Contains("gRPC::grpc++"));
}

TEST(Layout, TheWorkersFilesAreLinkedWithNoService) {
  const std::set<std::string> linked = LinkedInto("ballpiston_worker_files");
  EXPECT_THAT(linked, Contains("ballpiston_storage"));
  for (const char* library : {"ballpiston_proto", "ballpiston_server", "gRPC::grpc++",
                              "SQLite::SQLite3", "OpenSSL::SSL"}) {
    EXPECT_THAT(linked, Not(Contains(library)));
  }
}

TEST(IncludeRules, IncludesAreFoundInOrder) {
  EXPECT_THAT(IncludesOf("#include <vector>\n\n  #  include \"core/a.h\"\n// #include <thread>\n"),
              ElementsAre("vector", "core/a.h"));
}

TEST(IncludeRules, DownwardIncludesArePermitted) {
  EXPECT_THAT(WrongIncludes("core/billiard/x.cc",
                            "#include <cmath>\n#include \"core/sampling/direction.h\"\n"
                            "#include \"core/geometry/pair_geometry.h\"\n#include <Eigen/Core>\n"),
              IsEmpty());
  EXPECT_THAT(WrongIncludes("server/book/x.cc",
                            "#include <thread>\n#include <sys/stat.h>\n"
                            "#include \"server/store/store.h\"\n"
                            "#include \"core/ensemble/chunk_plan.h\"\n"),
              IsEmpty());
}

TEST(IncludeRules, GeometryIncludesNothingAboveIt) {
  ExpectWrong("core/geometry/x.h", "\"core/closed_form/kernel.h\"");
  ExpectWrong("core/geometry/x.h", "\"core/sampling/direction.h\"");
}

TEST(IncludeRules, FoldersOfTheServerIncludeInOneDirection) {
  ExpectWrong("server/convert/x.h", "\"server/door/principal.h\"");
  ExpectWrong("server/convert/x.h", "\"server/compute/lease.h\"");
  ExpectWrong("server/compute/x.cc", "\"server/cluster/folder_executor.h\"");
  ExpectWrong("server/store/x.cc", "\"server/book/job.h\"");
  ExpectWrong("server/door/x.cc", "\"server/rpc/call.h\"");
}

TEST(IncludeRules, ClosedFormAndSamplingAreSeparate) {
  ExpectWrong("core/closed_form/x.cc", "\"core/sampling/direction.h\"");
  ExpectWrong("core/sampling/x.cc", "\"core/closed_form/kernel.h\"");
}

TEST(IncludeRules, BilliardIncludesNoExperiment) {
  ExpectWrong("core/billiard/x.h", "\"core/ensemble/chunk_plan.h\"");
  ExpectWrong("core/billiard/x.h", "\"core/statistics/moments.h\"");
}

// Only the tools that compare precisions use multiprecision numbers.
TEST(IncludeRules, OnlyToolsUseBoostsNumbers) {
  const std::string numbers = "#include <boost/multiprecision/eigen.hpp>\n";
  EXPECT_THAT(WrongIncludes("tools/flows/x.h", numbers), IsEmpty());
  for (const char* path : {"core/billiard/x.h", "tools/method_comparison/x.h"}) {
    EXPECT_THAT(WrongIncludes(path, numbers), SizeIs(1)) << path;
  }
}

TEST(IncludeRules, StatisticsIncludesNoPhysics) {
  ExpectWrong("core/statistics/x.h", "\"core/geometry/pair_geometry.h\"");
  ExpectWrong("core/statistics/x.h", "\"core/closed_form/kernel.h\"");
}

TEST(IncludeRules, TheCoreUsesNoServiceThreadsOrClock) {
  for (const char* include :
       {"\"ballpiston/v1/result.pb.h\"", "<google/protobuf/message.h>", "<grpcpp/grpcpp.h>",
        "<sqlite3.h>", "\"server/store/store.h\"", "\"client/library/client.h\"", "<thread>",
        "<mutex>", "<chrono>", "<ctime>", "<time.h>", "\"absl/time/clock.h\"", "<unistd.h>",
        "<CLI/CLI.hpp>"}) {
    ExpectWrong("core/experiment/x.cc", include);
    ExpectWrong("core/geometry/x.cc", include);
  }
}

TEST(IncludeRules, TheClientIncludesOnlyTheProtos) {
  for (const char* include :
       {"\"core/geometry/pair_geometry.h\"", "\"server/convert/spec.h\"", "<sqlite3.h>",
        "<Eigen/Core>", "<Random123/philox.h>", "\"tests/layout/include_rules.h\""}) {
    ExpectWrong("client/command/x.cc", include);
  }
}

TEST(IncludeRules, TheServerDoesNotIncludeTheClient) {
  ExpectWrong("server/rpc/x.cc", "\"client/library/client.h\"");
  ExpectWrong("server/rpc/x.cc", "\"tests/layout/include_rules.h\"");
}

TEST(IncludeRules, ToolsIncludeOnlyTheCore) {
  EXPECT_THAT(WrongIncludes("tools/stability/x.cc",
                            "#include <thread>\n#include <unistd.h>\n#include <hwy/highway.h>\n"
                            "#include \"core/billiard/orbits.h\"\n"
                            "#include \"tools/stability/report.h\"\n"),
              IsEmpty());
  for (const char* include :
       {"\"server/store/store.h\"", "\"client/library/client.h\"", "\"ballpiston/v1/result.pb.h\"",
        "\"tests/oracle/exact_flight.h\"", "<gtest/gtest.h>", "<grpcpp/grpcpp.h>", "<sqlite3.h>"}) {
    ExpectWrong("tools/stability/x.cc", include);
  }
}

TEST(IncludeRules, OnlyTheirTestsIncludeTheTools) {
  const std::string tool = "\"tools/stability/report.h\"";
  EXPECT_THAT(WrongIncludes("tests/tools/stability/x.cc", "#include " + tool), IsEmpty());
  for (const char* path :
       {"core/billiard/x.cc", "server/book/x.cc", "client/command/x.cc",
        "tools/method_comparison/x.cc", "tests/core/billiard/x.cc", "tests/end_to_end/x.cc"}) {
    ExpectWrong(path, tool);
  }
  ExpectWrong("tests/tools/stability/x.cc", "\"server/store/store.h\"");
}

TEST(IncludeRules, OneFolderOfTheServerParsesFlags) {
  EXPECT_THAT(WrongIncludes("server/command_line/x.cc", "#include <CLI/CLI.hpp>\n"), IsEmpty());
  ExpectWrong("server/command_line/x.cc", "\"core/ensemble/chunk_plan.h\"");
  for (const char* path : {"server/rpc/x.cc", "server/main.cc"}) {
    ExpectWrong(path, "<CLI/CLI.hpp>");
  }
}

TEST(IncludeRules, TheWorkerIncludesNoService) {
  EXPECT_THAT(WrongIncludes("server/worker/x.cc",
                            "#include <fcntl.h>\n#include \"core/ensemble/chunk_fold.h\"\n"
                            "#include \"server/worker/lease_record.h\"\n"
                            "#include \"ballpiston/storage/records.pb.h\"\n"),
              IsEmpty());
  for (const char* include :
       {"\"ballpiston/v1/spec.pb.h\"", "\"server/convert/spec.h\"", "\"server/store/store.h\"",
        "\"server/compute/scheduler.h\"", "<grpcpp/grpcpp.h>", "<sqlite3.h>", "<openssl/sha.h>"}) {
    ExpectWrong("server/worker/x.cc", include);
  }
}

TEST(IncludeRules, PhysicsAndMessagesMeetInConvertOnly) {
  const std::string both =
      "#include \"core/ensemble/ensemble_spec.h\"\n#include \"ballpiston/v1/spec.pb.h\"\n";
  EXPECT_THAT(WrongIncludes("server/book/x.cc", both), SizeIs(1));
  EXPECT_THAT(WrongIncludes("server/convert/x.cc", both), IsEmpty());
}

TEST(IncludeRules, TestsIncludeNoLayerAboveTheirOwn) {
  ExpectWrong("tests/core/geometry/x.cc", "\"server/store/store.h\"");
  ExpectWrong("tests/core/geometry/x.cc", "\"ballpiston/v1/spec.pb.h\"");
  ExpectWrong("tests/statistical/x.cc", "\"server/store/store.h\"");
  ExpectWrong("tests/client/x.cc", "\"core/geometry/pair_geometry.h\"");
}

TEST(IncludeRules, SupportOfTestsIsForTestsOfAllLayers) {
  const std::string text =
      "#include <unistd.h>\n#include \"absl/status/status.h\"\n#include \"gtest/gtest.h\"\n"
      "#include \"tests/support/paths.h\"\n";
  EXPECT_THAT(WrongIncludes("tests/support/process.cc", text), IsEmpty());
  for (const char* include : {"\"core/geometry/pair_geometry.h\"", "\"server/ballpiston_server.h\"",
                              "\"client/library/client.h\"", "\"ballpiston/v1/spec.pb.h\"",
                              "\"grpcpp/channel.h\"", "\"tests/core/geometries.h\""}) {
    ExpectWrong("tests/support/process.cc", include);
  }
  for (const std::string folder : {"core", "statistical", "oracle", "client", "server", "layout"}) {
    EXPECT_THAT(WrongIncludes("tests/" + folder + "/x.cc", "#include \"tests/support/paths.h\"\n"),
                IsEmpty());
  }
}

TEST(IncludeRules, OnlyTestsOfTheServerIncludeARunningServer) {
  const std::string include = "\"tests/server/running_server.h\"";
  EXPECT_THAT(WrongIncludes("tests/server/x.cc", "#include " + include + "\n"), IsEmpty());
  for (const char* path : {"tests/core/geometry/x.cc", "tests/statistical/x.cc", "tests/oracle/x.h",
                           "tests/benchmark/x.cc", "tests/client/x.cc", "tests/support/paths.cc"}) {
    ExpectWrong(path, include);
  }
}

TEST(IncludeRules, AFolderWithoutARuleIsAnError) {
  EXPECT_THAT(WrongIncludes("core/thermostat/x.cc", ""), SizeIs(1));
}

}  // namespace
}  // namespace ballpiston
