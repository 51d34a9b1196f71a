// The cost of the service compared with the engine alone.
#include <sched.h>

#include "tests/fault/torture/costs.h"
#include "tests/fault/torture/preamble.h"

namespace ballpiston::torture {
namespace {

constexpr double kMostOverhead = 0.02;
// A busy machine may interrupt the short form at any moment, but processor time does not count
// waiting.
constexpr double kMostRatioOfShortForm = 3;
// Programs and threads that this thread starts meanwhile run on the first cores only, because other
// programs may slow some cores more than others.
class OnFirstCores {
 public:
  explicit OnFirstCores(int count) {
    sched_getaffinity(0, sizeof(before_), &before_);
    cpu_set_t first;
    CPU_ZERO(&first);
    for (int core = 0; core < CPU_SETSIZE && CPU_COUNT(&first) < count; ++core) {
      if (CPU_ISSET(core, &before_)) CPU_SET(core, &first);
    }
    sched_setaffinity(0, sizeof(first), &first);
  }
  ~OnFirstCores() { sched_setaffinity(0, sizeof(before_), &before_); }
  OnFirstCores(const OnFirstCores&) = delete;
  OnFirstCores& operator=(const OnFirstCores&) = delete;

 private:
  cpu_set_t before_;
};

// The same question for both in turn. While the engine computes, the server is idle.
void Compare(int workers, const std::string& name, Findings& findings) {
  const OnFirstCores pinned(workers);
  const v1::EnsembleSpec question = ManyPoints(1, Size(300'000, 10'000'000));
  ConnectedServer server({.workers = workers});
  server.Start();
  const client::Client client = server.NewClient();
  ServerCost(server, client, question);  // both warm
  EngineCost(question);
  PairedRatio processor;
  for (int i = 0; i < Size(1, 60); ++i) {
    const double with = ServerCost(server, client, question);
    processor.Add(with, EngineCost(question));
    findings.Count("pairs of answers");
  }
  findings.Note("processor time a sample, " + name, processor.Text());
  EXPECT_LT(processor.ratio(), kMostRatioOfShortForm) << name;
  if (HoldsToTimes()) {
    EXPECT_LT(processor.ratio() - 1, kMostOverhead + 2 * processor.StandardError()) << name;
    EXPECT_LT(processor.StandardError(), kMostOverhead / 2) << "too noisy to tell";
  }
}

TEST(Overhead, OfTheServiceIsSmall) {
  Findings findings("overhead");
  Compare(1, "1 worker", findings);
  Compare(2, "2 workers", findings);
}

}  // namespace
}  // namespace ballpiston::torture
