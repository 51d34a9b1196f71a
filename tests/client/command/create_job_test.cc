// Submission of a job: its request id, its options, answers from the store, limits.
#include "client/command/create_job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "client/library/request_id.h"
#include "tests/client/program.h"

namespace ballpiston::client {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class CreateJobTest : public ProgramTest {
 protected:
  // The request id of `submit --resume WORDS`.
  std::string IdOfResumed(std::vector<std::string> words) {
    words.insert(words.begin(), {"submit", "--resume"});
    const Outcome outcome = WithServer(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return server_.ensemble.Asked().create.back().request_id();
  }
};

TEST_F(CreateJobTest, ResumedJobsOfOneSpecificationHaveOneRequestId) {
  server_.server.status.set_engine_version("7");
  const std::string id = IdOfResumed({"first-hit", "--rho", "0.53"});
  EXPECT_TRUE(IsRequestId(id));
  EXPECT_EQ(IdOfResumed({"first-hit", "--rho=0.53"}), id);
  for (const std::vector<std::string>& other :
       {std::vector<std::string>{"first-hit", "--rho", "0.54"},
        {"first-hit", "--rho", "0.53", "--seed", "1"},
        {"first-hit", "--rho", "0.53", "--fresh"},
        {"first-hit", "--rho", "0.53", "--priority", "1"}}) {
    EXPECT_NE(IdOfResumed(other), id);
  }
  server_.server.status.set_engine_version("8");
  EXPECT_NE(IdOfResumed({"first-hit", "--rho", "0.53"}), id);
}

TEST_F(CreateJobTest, ResumeAfterAFailedOrCancelledJobCreatesANewJob) {
  server_.ensemble.created_states = {v1::EnsembleJob::FAILED, v1::EnsembleJob::CANCELLED,
                                     v1::EnsembleJob::CANCELLING, v1::EnsembleJob::QUEUED};
  EXPECT_EQ(WithServer({"submit", "--resume", "first-hit"}).code, 0);
  const auto asked = server_.ensemble.Asked().create;
  ASSERT_EQ(asked.size(), 4u);
  EXPECT_NE(asked[0].request_id(), asked[1].request_id());
  EXPECT_NE(asked[1].request_id(), asked[2].request_id());
  EXPECT_NE(asked[2].request_id(), asked[3].request_id());
}

TEST_F(CreateJobTest, WithoutResumeEachJobHasANewRequestId) {
  server_.ensemble.created_states = {v1::EnsembleJob::FAILED};
  for (int i = 0; i < 2; ++i) EXPECT_EQ(WithServer({"submit", "first-hit"}).code, 0);
  const auto asked = server_.ensemble.Asked().create;
  ASSERT_EQ(asked.size(), 2u);
  EXPECT_NE(asked[0].request_id(), asked[1].request_id());
}

TEST_F(CreateJobTest, TheUsersRequestIdIsSent) {
  const std::string id = "123e4567-e89b-12d3-a456-426614174000";
  for (const char* verb : {"submit", "run"}) {
    const Outcome outcome = WithServer({verb, "first-hit", "--resume", "--request-id", id});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(server_.ensemble.Asked().create.back().request_id(), id);
  }
}

TEST_F(CreateJobTest, FreshAndPriorityReachTheServer) {
  EXPECT_EQ(WithServer({"submit", "equilibrium"}).code, 0);
  EXPECT_EQ(WithServer({"submit", "equilibrium", "--fresh", "--priority", "-7"}).code, 0);
  EXPECT_EQ(WithServer({"run", "equilibrium", "--priority", "1e10", "--fresh"}).code, 0);
  const auto asked = server_.ensemble.Asked().create;
  ASSERT_EQ(asked.size(), 3u);
  EXPECT_FALSE(asked[0].fresh());
  EXPECT_EQ(asked[0].priority(), 0);
  EXPECT_TRUE(asked[1].fresh());
  EXPECT_EQ(asked[1].priority(), -7);
  EXPECT_TRUE(asked[2].fresh());
  EXPECT_EQ(asked[2].priority(), INT32_MAX);  // the server rejects it
}

TEST_F(CreateJobTest, AnAnswerFromTheStoreIsNoted) {
  job().mutable_end_time()->set_seconds(1700000000);
  server_.ensemble.answers_from_store = true;
  const std::string note = "answered from the store: " + job().name() +
                           ", computed 2023-11-14 22:13 UTC (--fresh computes it again)";
  const Outcome submitted = WithServer({"submit", "equilibrium"});
  EXPECT_EQ(submitted.out, job().name() + "\n");
  EXPECT_EQ(submitted.err, note + "\n");
  const Outcome table = WithServer({"run", "equilibrium"});
  EXPECT_EQ(table.err, note + "\n");
  EXPECT_EQ(table.out, WithServer({"result", job().name()}).out);
  EXPECT_THAT(WithServer({"run", "equilibrium", "--progress", "json"}).err,
              HasSubstr("\"note\":\"" + note + "\"}\n{\"job\":"));
  const Outcome quiet =
      WithServer({"run", "equilibrium", "--progress", "none", "--format", "json"});
  EXPECT_EQ(quiet.err, "");
  EXPECT_THAT(quiet.out, HasSubstr("\"answered_from_store\":true"));
}

TEST_F(CreateJobTest, AContinuedAnswerIsNoted) {
  job().set_continues("ensembleJobs/d");
  job().set_continued_samples(1'000'000);
  EXPECT_EQ(WithServer({"submit", "equilibrium"}).err,
            "continues ensembleJobs/d: 1000000 samples are in the store (--fresh computes them "
            "again)\n");
}

TEST_F(CreateJobTest, AComputedAnswerHasNoNote) {
  EXPECT_EQ(WithServer({"submit", "equilibrium"}).err, "");
  const Outcome run = WithServer({"run", "equilibrium", "--format", "json"});
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("\"answered_from_store\":false"));
}

// A limit on a single job is wrong usage; a limit on the server's total work passes.
TEST_F(CreateJobTest, AnExceededLimitHasAHint) {
  const struct {
    std::string reason;
    int code;
    std::string hint;
  } limits[] = {{"QUEUE_FULL", 3, "Retry when some of the jobs have ended."},
                {"TOO_MANY_POINTS", 2, "Split the grid between several jobs."},
                {"TOO_MANY_STORED_BYTES", 3,
                 "Delete jobs that are no longer needed: ballpiston list, ballpiston delete JOB"}};
  for (const auto& [reason, code, hint] : limits) {
    server_.ensemble.create_end = LimitExceeded(reason, "9 are too many");
    const std::string error = "ballpiston: 9 are too many (" + reason + ")\n" + hint + "\n";
    for (const char* verb : {"run", "submit"}) {
      EXPECT_EQ(WithServer({verb, "equilibrium"}), (Outcome{code, "", error}));
    }
  }
}

// Such a request is larger than gRPC's default limit of 4 MiB; the server has a different limit.
TEST_F(CreateJobTest, LargeRequestsAreSent) {
  server_.largest_request = -1;
  const std::string list = "0:1:100000";
  const Outcome outcome = WithServer({"submit", "first-hit", "--rho", list, "--delta", list,
                                      "--epsilon", list, "--exponent", list});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(server_.ensemble.Asked().create.at(0).spec().grid().exponent_size(), 100'000);
}

}  // namespace
}  // namespace ballpiston::client
