// Submission of a job: its request id, and its size. transcripts/submit.txt shows the rest.
#include "client/command/create_job.h"

#include "client/library/request_id.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

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
