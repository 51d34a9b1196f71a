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

v1::EnsembleSpec Conduction(int64_t samples) {
  return FromText<v1::EnsembleSpec>(absl::StrCat(
      "experiment: GAS_CONDUCTION model: MARKOV grid { rho: 0.53 delta: 0.1 cells: '2' "
      "hot: 2 cold: 1 } target { samples: ",
      samples, " }"));
}

class ContinuationTest : public testing::Test {
 protected:
  ContinuationTest() { server_.emplace(TestServerOptions{.factory = nullptr}); }

  v1::EnsembleJob Ask(const v1::EnsembleSpec& spec, bool fresh = false) {
    const v1::EnsembleJob job = server_->Created(fresh ? FreshRequest(spec) : CreateRequest(spec));
    EXPECT_EQ(server_->AwaitEnd(job.name()).state(), v1::EnsembleJob::SUCCEEDED);
    return job;
  }

  std::optional<RunningServer> server_;
};

TEST_F(ContinuationTest, AContinuedJobHasTheBytesOfOneLongRun) {
  const std::pair<v1::EnsembleSpec, v1::EnsembleSpec> rows[] = {
      {WithSamples(1'000), WithSamples(30'000)},
      {WithTolerance(0.05), WithTolerance(0.01)},
      // Both have 128 samples, one of each trajectory.
      {Conduction(90), Conduction(100)},
      // A run with this tolerance would have ended long before the samples of the earlier job.
      {WithSamples(50'000), WithTolerance(0.1)}};
  for (const auto& [earlier, later] : rows) {
    SCOPED_TRACE(earlier.target().ShortDebugString());
    server_.emplace(TestServerOptions{.factory = nullptr});
    const v1::EnsembleJob first = Ask(earlier), longer = Ask(later), at_once = Ask(later, true);
    EXPECT_EQ(longer.continues(), first.name());
    EXPECT_EQ(at_once.continues(), "");
    EXPECT_EQ(server_->ResultBytes(longer.name()), server_->ResultBytes(at_once.name()));
  }
}

TEST_F(ContinuationTest, TheJobWithTheMostSamplesBelowTheTargetIsContinued) {
  const std::string first = Ask(WithSamples(1'000)).name();
  const std::string middle = Ask(WithSamples(5'000)).name();
  Ask(WithSamples(20'000));
  const v1::EnsembleJob longer = Ask(WithSamples(10'000));
  EXPECT_EQ(longer.continues(), middle);
  EXPECT_EQ(longer.continued_samples(), 5'000);
  EXPECT_OK(server_->Delete(first));
  EXPECT_EQ(Ask(WithSamples(2'000)).continues(), "");
}

TEST_F(ContinuationTest, ALargerToleranceDoesNotContinueASmallerOne) {
  Ask(WithTolerance(0.05));
  EXPECT_EQ(Ask(WithTolerance(0.2)).continues(), "");
}

// A sample is an orbit of 40 mean free times, so the second job has fewer samples.
TEST_F(ContinuationTest, JobsWithCollisionsAreComparedByTheirSamples) {
  const auto ask = [this](const std::string& target) {
    return Ask(FromText<v1::EnsembleSpec>(
        "experiment: ENERGY_RELAXATION grid { rho: 0.53 delta: 0.2 } model: BILLIARD target { " +
        target + " }"));
  };
  const std::string first = ask("samples: 500").name();
  EXPECT_EQ(ask("collisions: 10000").continues(), "");
  EXPECT_EQ(ask("collisions: 100000").continues(), first);
}

}  // namespace
}  // namespace ballpiston::server
