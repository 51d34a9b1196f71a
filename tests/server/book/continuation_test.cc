// Which job a new one continues, and its result.
#include "server/book/acceptance.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

v1::EnsembleSpec FirstHits(const std::string& more = "") {
  return FromText<v1::EnsembleSpec>(
      "experiment: FIRST_HIT grid { rho: 0.53 delta: 0.2 epsilon: 0.125 exponent: 1 } " + more);
}

v1::EnsembleSpec WithSamples(int64_t samples) {
  return FirstHits(absl::StrCat("target { samples: ", samples, " }"));
}

v1::EnsembleSpec WithTolerance(double tolerance) {
  return FirstHits(absl::StrCat("target { tolerance: ", tolerance, " }"));
}

TEST(Family, IsTheQuestionWithoutItsTargetButWithItsEstimate) {
  const std::string family = FamilyOf(FirstHits(), "1");
  EXPECT_EQ(FamilyOf(WithSamples(7), "1"), family);
  EXPECT_EQ(FamilyOf(WithTolerance(0.5), "1"), family);
  EXPECT_NE(FamilyOf(FirstHits(), "2"), family);
  EXPECT_NE(QuestionOf(FirstHits(), "1"), family);
  EXPECT_NE(FamilyOf(FirstHits("seed: 1"), "1"), family);
  const std::string estimate = "estimate: 'mean_sigma'";
  EXPECT_NE(FamilyOf(FirstHits("target { " + estimate + " }"), "1"), family);
  EXPECT_EQ(FamilyOf(FirstHits("target { " + estimate + " budget { seconds: 1 } }"), "1"), "");
}

class ContinuationTest : public testing::Test {
 protected:
  ContinuationTest() : server_({.factory = nullptr}) {}

  v1::EnsembleJob Ask(const v1::EnsembleSpec& spec, bool fresh = false) {
    v1::CreateEnsembleJobRequest request;
    *request.mutable_spec() = spec;
    request.set_fresh(fresh);
    const v1::EnsembleJob job = server_.Created(request);
    EXPECT_EQ(server_.AwaitEnd(job.name()).state(), v1::EnsembleJob::SUCCEEDED);
    return job;
  }

  RunningServer server_;
};

TEST_F(ContinuationTest, ALargerTargetContinuesToTheBytesOfOneLongRun) {
  const std::string first = Ask(WithSamples(1'000)).name();
  const v1::EnsembleJob longer = Ask(WithSamples(30'000));
  EXPECT_EQ(longer.continues(), first);
  EXPECT_EQ(longer.continued_samples(), 1'000);
  const v1::EnsembleJob at_once = Ask(WithSamples(30'000), true);
  EXPECT_EQ(at_once.continues(), "");
  EXPECT_EQ(server_.ResultBytes(longer.name()), server_.ResultBytes(at_once.name()));
}

TEST_F(ContinuationTest, TheJobWithTheMostSamplesBelowTheTargetIsContinued) {
  Ask(WithSamples(1'000));
  const std::string middle = Ask(WithSamples(5'000)).name();
  Ask(WithSamples(20'000));
  EXPECT_EQ(Ask(WithSamples(10'000)).continues(), middle);
  EXPECT_EQ(Ask(WithSamples(500)).continues(), "");
}

TEST_F(ContinuationTest, ASmallerToleranceContinuesALargerOne) {
  const std::string first = Ask(WithTolerance(0.05)).name();
  const v1::EnsembleJob longer = Ask(WithTolerance(0.01));
  EXPECT_EQ(longer.continues(), first);
  EXPECT_EQ(server_.ResultBytes(longer.name()),
            server_.ResultBytes(Ask(WithTolerance(0.01), true).name()));
  EXPECT_EQ(Ask(WithTolerance(0.2)).continues(), "");
}

// A run with this tolerance would have ended long before the samples of the earlier job.
TEST_F(ContinuationTest, AToleranceThatWasReachedEarlierBeginsAnew) {
  Ask(WithSamples(50'000));
  const v1::EnsembleJob tolerant = Ask(WithTolerance(0.1));
  EXPECT_NE(tolerant.continues(), "");
  EXPECT_EQ(server_.ResultBytes(tolerant.name()),
            server_.ResultBytes(Ask(WithTolerance(0.1), true).name()));
}

TEST_F(ContinuationTest, ADeletedJobIsNotContinued) {
  const std::string first = Ask(WithSamples(1'000)).name();
  EXPECT_TRUE(server_.Delete(first).ok());
  EXPECT_EQ(Ask(WithSamples(2'000)).continues(), "");
}

}  // namespace
}  // namespace ballpiston::server
