#include "client/output/status_output.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/message_text.h"

namespace ballpiston::client {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

v1::ServerStatus BusyServer() {
  return FromText<v1::ServerStatus>(
      R"(state: SERVING version: "0.1.0" engine_version: "0.3.0" start_time { seconds: 1700000000 }
         workers: 2 busy_workers: 1 queued_jobs: 3 running_jobs: 1 streams: 4 store_bytes: 70048
         stored_jobs: 1024 blocks_computed: 5000 samples_computed: 1.28e9
         processor_seconds: 5400 rates { wall_hit: 2e-9 jump: 8e-9 }
         limits { max_points_per_job: 100000 max_samples_per_job: 1e15
                  max_active_jobs_per_principal: 1000 max_active_points_per_principal: 5000000
                  max_streams_per_principal: 2048 max_message_bytes: 4194304 retain_days: 30 }
         expiring_jobs: 12
         principal: "alice" role: "submit"
         principals { principal: "alice" queued_jobs: 3 running_jobs: 1 streams: 4 stored_jobs: 1000
                      stored_bytes: 60000 })");
}

std::string PrintedStatus(const v1::ServerStatus& status, Format format = Format::kTable) {
  std::ostringstream out;
  PrintStatus(status, absl::FromUnixSeconds(1700000000 + 7200), format, out);
  return out.str();
}

TEST(StatusOutput, TheTableHasEverything) {
  EXPECT_EQ(PrintedStatus(BusyServer()),
            R"(server    0.1.0
engine    0.3.0
state     serving
started   2023-11-14T22:13:20Z, 2.0 h ago
you       alice, role submit
jobs      3 queued, 1 running, 1024 in the store
workers   1 of 2 busy
computed  1.28e+09 samples in 5000 blocks, 1.5 h of processor time
speed     500 million wall hits/s, 125 million jumps/s per core
streams   4
store     68 KiB
expiry    results of 12 jobs expire within a week

principal  queued  running  streams  stored  stored bytes
alice           3        1        4    1000        59 KiB

limit                            most
points of a job                100000
samples of a job                1e+15
active jobs of a principal       1000
active points of a principal  5000000
streams of a principal           2048
message                       4.0 MiB
results kept                  30 days
)");
}

TEST(StatusOutput, ZeroMeansUnlimited) {
  v1::ServerStatus status = BusyServer();
  status.mutable_limits()->Clear();
  const std::string table = PrintedStatus(status);
  EXPECT_THAT(table, HasSubstr("points of a job               no limit\n"));
  EXPECT_THAT(table, HasSubstr("message                       no limit\n"));
  EXPECT_THAT(table, HasSubstr("results kept                  no limit\n"));
}

TEST(StatusOutput, NamesOtherStatesThanServing) {
  v1::ServerStatus status = BusyServer();
  status.set_state(v1::ServerStatus::STORE_FAILING);
  EXPECT_THAT(PrintedStatus(status), HasSubstr("state     store-failing\n"));
  status.set_state(v1::ServerStatus::DRAINING);
  EXPECT_THAT(PrintedStatus(status), HasSubstr("state     draining\n"));
}

TEST(StatusOutput, WithoutActivePrincipalsTheirTableIsLeftOut) {
  v1::ServerStatus status = BusyServer();
  status.clear_principals();
  EXPECT_THAT(PrintedStatus(status), Not(HasSubstr("principal  queued")));
}

TEST(StatusOutput, WithoutExpiringJobsTheirLineIsLeftOut) {
  v1::ServerStatus status = BusyServer();
  status.set_expiring_jobs(1);
  EXPECT_THAT(PrintedStatus(status), HasSubstr("results of 1 job expire within a week\n"));
  status.set_expiring_jobs(0);
  EXPECT_THAT(PrintedStatus(status), Not(HasSubstr("expire")));
}

TEST(StatusOutput, ATimeInTheFutureIsZeroSecondsAgo) {
  v1::ServerStatus status = BusyServer();
  status.mutable_start_time()->set_seconds(1700000000 + 9999);
  EXPECT_THAT(PrintedStatus(status), HasSubstr(", 0 s ago"));
}

TEST(StatusOutput, JsonIsTheMessage) {
  const std::string text = PrintedStatus(BusyServer(), Format::kJson);
  v1::ServerStatus read;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(text, &read).ok()) << text;
  EXPECT_EQ(read.SerializeAsString(), BusyServer().SerializeAsString());
  EXPECT_THAT(text, HasSubstr("\"queued_jobs\":3,"));
}

}  // namespace
}  // namespace ballpiston::client
