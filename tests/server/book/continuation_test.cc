// Which job a new one continues, and its result.
#include "server/book/acceptance.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

const char kFirstHits[] =
    "experiment: FIRST_HIT grid { rho: 0.53 delta: 0.2 epsilon: 0.125 exponent: 1 }";
const char kConduction[] =
    "experiment: GAS_CONDUCTION model: MARKOV "
    "grid { rho: 0.53 delta: 0.1 cells: '2' hot: 2 cold: 1 }";
const char kRelaxation[] =
    "experiment: ENERGY_RELAXATION model: BILLIARD grid { rho: 0.53 delta: 0.2 }";

class ContinuationTest : public testing::Test {
 protected:
  ContinuationTest() { Start(); }

  void Start() { server_.emplace(TestServerOptions{.factory = nullptr}); }

  v1::EnsembleJob Ask(const std::string& question, const std::string& target, bool fresh = false) {
    v1::CreateEnsembleJobRequest request =
        CreateRequest(FromText<v1::EnsembleSpec>(question + " target { " + target + " }"));
    request.set_fresh(fresh);
    const v1::EnsembleJob job = server_->Created(request);
    EXPECT_EQ(server_->AwaitEnd(job.name()).state(), v1::EnsembleJob::SUCCEEDED);
    return job;
  }

  std::optional<RunningServer> server_;
};

TEST_F(ContinuationTest, AContinuedJobHasTheBytesOfOneLongRun) {
  const struct {
    const char *question, *earlier, *later;
  } rows[] = {{kFirstHits, "samples: 1000", "samples: 30000"},
              {kFirstHits, "tolerance: 0.05", "tolerance: 0.01"},
              // Both have 128 samples, one of each trajectory.
              {kConduction, "samples: 90", "samples: 100"},
              // A run with this tolerance would have ended long before the samples of the first.
              {kFirstHits, "samples: 50000", "tolerance: 0.1"}};
  for (const auto& [question, earlier, later] : rows) {
    SCOPED_TRACE(later);
    Start();
    const v1::EnsembleJob first = Ask(question, earlier);
    const v1::EnsembleJob longer = Ask(question, later);
    const v1::EnsembleJob at_once = Ask(question, later, /*fresh=*/true);
    EXPECT_EQ(longer.continues(), first.name());
    EXPECT_EQ(at_once.continues(), "");
    EXPECT_EQ(server_->ResultBytes(longer.name()), server_->ResultBytes(at_once.name()));
  }
}

TEST_F(ContinuationTest, TheJobWithTheMostSamplesBelowTheTargetIsContinued) {
  const std::string first = Ask(kFirstHits, "samples: 1000").name();
  const std::string middle = Ask(kFirstHits, "samples: 5000").name();
  Ask(kFirstHits, "samples: 20000");
  const v1::EnsembleJob longer = Ask(kFirstHits, "samples: 10000");
  EXPECT_EQ(longer.continues(), middle);
  EXPECT_EQ(longer.continued_samples(), 5'000);
  EXPECT_OK(server_->Delete(first));
  EXPECT_EQ(Ask(kFirstHits, "samples: 2000").continues(), "");
}

TEST_F(ContinuationTest, ALargerToleranceDoesNotContinueASmallerOne) {
  Ask(kFirstHits, "tolerance: 0.05");
  EXPECT_EQ(Ask(kFirstHits, "tolerance: 0.2").continues(), "");
}

// A sample is an orbit of 40 mean free times, so the second job has fewer samples.
TEST_F(ContinuationTest, JobsWithCollisionsAreComparedByTheirSamples) {
  const std::string first = Ask(kRelaxation, "samples: 500").name();
  EXPECT_EQ(Ask(kRelaxation, "collisions: 10000").continues(), "");
  EXPECT_EQ(Ask(kRelaxation, "collisions: 100000").continues(), first);
}

}  // namespace
}  // namespace ballpiston::server
