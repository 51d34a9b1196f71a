// Tests that the folder rules hold in this tree, and that each rule can fail.
#include <filesystem>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/layout/include_rules.h"
#include "tests/layout/source_files.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

std::vector<std::string> Words(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

// Every target that `program` is linked with, through however many others. Written by CMake.
std::vector<std::string> LinkedInto(const std::string& program) {
  return Words(Contents(BuildPath("tests/layout/links/" + program + ".txt")));
}

// What is wrong with a file that includes only this one.
std::vector<std::string> WrongIn(const std::string& path, const std::string& include) {
  return WrongIncludes(path, "#include <" + include + ">\n");
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

// Of the targets that must be linked, some are linked through others.
TEST(Layout, ProgramsAreLinkedWithTheirLayersOnly) {
  struct Links {
    const char* target;
    const char* with;
    const char* not_with;
  };
  const Links kLinks[] = {
      {"ballpiston", "ballpiston_proto", "ballpiston_core ballpiston_server"},
      {"ballpistond", "ballpiston_core gRPC::grpc++", ""},
      {"ballpiston_core", "Eigen3::Eigen",
       "ballpiston_proto protobuf::libprotobuf gRPC::grpc++ SQLite::SQLite3"},
      {"ballpiston_worker_files", "ballpiston_storage",
       "ballpiston_proto ballpiston_server gRPC::grpc++ SQLite::SQLite3 OpenSSL::SSL"}};
  for (const auto& [target, with, not_with] : kLinks) {
    const std::vector<std::string> linked = LinkedInto(target);
    for (const std::string& other : Words(with)) EXPECT_THAT(linked, Contains(other)) << target;
    for (const std::string& other : Words(not_with)) {
      EXPECT_THAT(linked, Not(Contains(other))) << target;
    }
  }
}

TEST(IncludeRules, IncludesAreFoundInOrder) {
  EXPECT_THAT(IncludesOf("#include <vector>\n\n  #  include \"core/a.h\"\n// #include <thread>\n"),
              ElementsAre("vector", "core/a.h"));
}

struct RuleExample {
  const char* path;
  const char* includes;
};

TEST(IncludeRules, LowerLayersArePermitted) {
  const RuleExample kPermitted[] = {
      {"core/billiard/x.cc",
       "cmath core/sampling/direction.h core/geometry/pair_geometry.h Eigen/Core"},
      {"server/book/x.cc", "thread sys/stat.h server/store/store.h core/ensemble/chunk_plan.h"},
      {"server/command_line/x.cc", "CLI/CLI.hpp"},
      {"server/worker/x.cc",
       "fcntl.h core/ensemble/chunk_fold.h server/worker/lease_record.h "
       "ballpiston/storage/records.pb.h"},
      {"tools/flows/x.h", "boost/multiprecision/eigen.hpp"},
      {"tools/stability/x.cc",
       "thread unistd.h hwy/highway.h core/billiard/orbits.h tools/stability/report.h"},
      {"tests/tools/stability/x.cc", "tools/stability/report.h"},
      {"tests/support/process.cc", "unistd.h absl/status/status.h gtest/gtest.h "},
      {"tests/core/x.cc", "tests/support/paths.h"},
      {"tests/statistical/x.cc", "tests/support/paths.h"},
      {"tests/oracle/x.cc", "tests/support/paths.h"},
      {"tests/client/x.cc", "tests/support/paths.h"},
      {"tests/server/x.cc", "tests/support/paths.h tests/server/running_server.h"},
  };
  for (const auto& [path, includes] : kPermitted) {
    for (const std::string& include : Words(includes)) {
      EXPECT_THAT(WrongIn(path, include), IsEmpty());
    }
  }
}

TEST(IncludeRules, OtherLayersAreForbidden) {
  const char* const kServiceThreadsAndClocks =
      "ballpiston/v1/result.pb.h google/protobuf/message.h grpcpp/grpcpp.h sqlite3.h "
      "server/store/store.h client/library/client.h thread mutex chrono ctime time.h "
      "absl/time/clock.h unistd.h CLI/CLI.hpp";
  const RuleExample kForbidden[] = {
      {"core/experiment/x.cc", kServiceThreadsAndClocks},
      {"core/geometry/x.cc", kServiceThreadsAndClocks},
      {"core/geometry/x.h", "core/closed_form/kernel.h core/sampling/direction.h"},
      {"core/closed_form/x.cc", "core/sampling/direction.h"},
      {"core/sampling/x.cc", "core/closed_form/kernel.h"},
      {"core/billiard/x.h",
       "core/ensemble/chunk_plan.h core/statistics/moments.h boost/multiprecision/eigen.hpp "
       "tools/stability/report.h"},
      {"core/statistics/x.h", "core/geometry/pair_geometry.h core/closed_form/kernel.h"},
      {"server/convert/x.h", "server/door/principal.h server/compute/lease.h"},
      {"server/compute/x.cc", "server/cluster/folder_executor.h"},
      {"server/store/x.cc", "server/book/job.h"},
      {"server/book/x.cc", "tools/stability/report.h"},
      {"server/door/x.cc", "server/rpc/call.h"},
      {"server/rpc/x.cc", "client/library/client.h tests/layout/include_rules.h CLI/CLI.hpp"},
      {"server/main.cc", "CLI/CLI.hpp"},
      {"server/command_line/x.cc", "core/ensemble/chunk_plan.h"},
      {"server/worker/x.cc",
       "ballpiston/v1/spec.pb.h server/convert/spec.h server/store/store.h "
       "server/compute/scheduler.h grpcpp/grpcpp.h sqlite3.h openssl/sha.h"},
      {"client/command/x.cc",
       "core/geometry/pair_geometry.h server/convert/spec.h sqlite3.h Eigen/Core "
       "Random123/philox.h tests/layout/include_rules.h tools/stability/report.h"},
      {"tools/method_comparison/x.h", "boost/multiprecision/eigen.hpp tools/stability/report.h"},
      {"tools/stability/x.cc",
       "server/store/store.h client/library/client.h ballpiston/v1/result.pb.h "
       "tests/oracle/exact_flight.h gtest/gtest.h grpcpp/grpcpp.h sqlite3.h"},
      {"tests/tools/stability/x.cc", "server/store/store.h"},
      {"tests/core/geometry/x.cc",
       "server/store/store.h ballpiston/v1/spec.pb.h tests/server/running_server.h "
       "tools/stability/report.h"},
      {"tests/statistical/x.cc", "server/store/store.h tests/server/running_server.h"},
      {"tests/oracle/x.h", "tests/server/running_server.h"},
      {"tests/benchmark/x.cc", "tests/server/running_server.h"},
      {"tests/client/x.cc", "core/geometry/pair_geometry.h tests/server/running_server.h"},
      {"tests/end_to_end/x.cc", "tools/stability/report.h"},
      {"tests/support/process.cc",
       "core/geometry/pair_geometry.h server/ballpiston_server.h client/library/client.h "
       "ballpiston/v1/spec.pb.h grpcpp/channel.h tests/core/geometries.h "
       "tests/server/running_server.h"},
  };
  for (const auto& [path, includes] : kForbidden) {
    for (const std::string& include : Words(includes)) {
      EXPECT_THAT(WrongIn(path, include), SizeIs(1)) << path << " includes " << include;
    }
  }
}

TEST(IncludeRules, PhysicsAndMessagesMeetInConvertOnly) {
  const std::string both =
      "#include \"core/ensemble/ensemble_spec.h\"\n#include \"ballpiston/v1/spec.pb.h\"\n";
  EXPECT_THAT(WrongIncludes("server/book/x.cc", both), SizeIs(1));
  EXPECT_THAT(WrongIncludes("server/convert/x.cc", both), IsEmpty());
}

TEST(IncludeRules, AFolderWithoutARuleIsAnError) {
  EXPECT_THAT(WrongIncludes("core/thermostat/x.cc", ""), SizeIs(1));
}

}  // namespace
}  // namespace ballpiston
