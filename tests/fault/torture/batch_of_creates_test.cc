// Many Creates at once with one request id, kills, and Creates again: one job.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <latch>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "client/library/client.h"
#include "client/library/error_text.h"
#include "client/library/request_id.h"
#include "tests/fault/torture/connected_server.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/sizes.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::torture {
namespace {

constexpr size_t kAtOnce = 64;
constexpr size_t kConnectionsOfCreates = 8;

using Channels = std::vector<std::shared_ptr<grpc::Channel>>;

Channels ConnectionsTo(ConnectedServer& server) {
  Channels channels;
  for (size_t i = 0; i < kConnectionsOfCreates; ++i) channels.push_back(server.Connect());
  return channels;
}

// Repeats the call while the server is down. Returns the name of the job, or another error.
std::string CreateInTheEnd(const std::shared_ptr<grpc::Channel>& channel,
                           const v1::EnsembleSpec& spec, const std::string& request_id) {
  const client::Client client(channel, absl::FromChrono(kPatience));
  while (true) {
    const auto job = client.Create(spec, {.request_id = request_id});
    if (job.ok()) return job->name();
    if (!absl::IsUnavailable(job.status())) return job.status().ToString();
    std::this_thread::sleep_for(kPauseBeforeRepeating);
    // If no caller waits, gRPC checks only every 5 s whether the channel is connected again.
    channel->WaitForConnected(std::chrono::system_clock::now() + kPauseBeforeRepeating);
  }
}

// The names of jobs in all answers to one request id.
std::set<std::string> NamesOfOneRequest(const Channels& channels, const v1::EnsembleSpec& spec,
                                        const std::string& request_id, ConnectedServer* to_kill) {
  std::vector<std::string> names(kAtOnce);
  std::latch together(kAtOnce);
  std::vector<std::thread> threads;
  for (size_t i = 0; i < kAtOnce; ++i) {
    threads.emplace_back([&, i] {
      together.arrive_and_wait();
      names[i] = CreateInTheEnd(channels[i % kConnectionsOfCreates], spec, request_id);
    });
  }
  if (to_kill != nullptr) {  // its failpoint is armed before
    EXPECT_EQ(to_kill->AwaitEnd(), 128 + SIGKILL);
    to_kill->Start();
  }
  for (std::thread& thread : threads) thread.join();
  return {names.begin(), names.end()};
}

class BatchOfCreates : public testing::Test {
 protected:
  // `failpoint`: where the first server is killed; empty: it is not killed.
  void Round(const v1::EnsembleSpec& spec, const std::string& failpoint) {
    server_.Spawn(failpoint);
    ASSERT_TRUE(server_.AwaitReady());
    const Channels channels = ConnectionsTo(server_);
    const std::string id = client::NewRequestId();
    const std::set<std::string> names =
        NamesOfOneRequest(channels, spec, id, failpoint.empty() ? nullptr : &server_);
    findings_.Count("times 64 Creates at once");
    if (!failpoint.empty()) findings_.Count("of which with a kill under them");
    ASSERT_EQ(names.size(), 1u) << testing::PrintToString(names);
    EXPECT_TRUE(made_.insert(*names.begin()).second);
    server_.KillHard();
    CheckReplay(spec, id, *names.begin());
  }

  void CheckReplay(const v1::EnsembleSpec& spec, const std::string& id, const std::string& name) {
    server_.Start();
    EXPECT_EQ(CreateInTheEnd(server_.Connect(), spec, id), name);
    const client::Client client = server_.NewClient();
    v1::EnsembleSpec other = spec;
    other.set_seed(spec.seed() + 1);
    const auto rejected = client.Create(other, {.request_id = id});
    EXPECT_THAT(rejected, StatusIs(absl::StatusCode::kInvalidArgument));
    EXPECT_EQ(client::ErrorReason(rejected.status()), "REQUEST_ID_REUSED");
    ASSERT_OK_AND_ASSIGN(const auto jobs, client.List());
    EXPECT_EQ(jobs.size(), made_.size());
    findings_.Count("replays after a kill");
    // The job is cancelled, so that the next server writes nothing until a client calls it.
    client.Cancel(name).status().IgnoreError();
    EXPECT_OK(client.Watch(name, {}, {.give_up_after = absl::FromChrono(kPatience)}));
    server_.KillHard();
  }

  Findings findings_{"one request id"};
  ConnectedServer server_;
  std::set<std::string> made_;
};

TEST_F(BatchOfCreates, MakesEachJobOnceThroughKills) {
  const std::vector<std::string> failpoints = {"",
                                               "create.in_transaction:1",
                                               "store.before_commit:ready+1",
                                               "store.after_commit:ready+1",
                                               "create.committed:1",
                                               "create.before_answer:1"};
  // Every question is different, so that the store has no answer.
  for (int round = 0; round < Size(6, 102); ++round) {
    v1::EnsembleSpec spec = ManyPoints(2, 1'000);
    spec.set_seed(static_cast<uint64_t>(10 * round));
    Round(spec, failpoints[static_cast<size_t>(round) % failpoints.size()]);
    if (HasFatalFailure()) return;
  }
  findings_.Count("jobs made", static_cast<int64_t>(made_.size()));
}

}  // namespace
}  // namespace ballpiston::torture
