// The processor time of the service beside that of its workers. The engine alone in another program
// is no measure: its code has other addresses there, and takes up to 4 % more or less time.
#include <sched.h>

#include "tests/fault/torture/costs.h"

namespace ballpiston::torture {
namespace {

constexpr double kMostOverhead = 0.01;

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

void Measure(int workers, const std::string& name, Findings& findings) {
  const OnFirstCores pinned(workers);
  v1::CreateEnsembleJobRequest question;
  *question.mutable_spec() = ManyPoints(1, Size(300'000, 10'000'000));
  question.set_fresh(true);
  ConnectedServer server({.workers = workers});
  server.Start();
  const client::Client client = server.NewClient();
  PairedRatio processor;  // of all threads, over the workers'
  for (int i = 0; i < Size(2, 30); ++i) {
    const double start = server.ProcessorSeconds();
    const std::string job = OrThrow(client.Create(question)).name();
    const double work = AwaitEnd(client, job).work();
    processor.Add(server.ProcessorSeconds() - start, work);
    findings.Count("jobs");
  }
  findings.Note("processor time beside the workers', " + name, processor.Text());
  EXPECT_LT(processor.ratio() - 1, kMostOverhead) << name;
}

// The short form's jobs take a fraction of a second, of which accepting and storing are a part.
TEST(Overhead, OfTheServiceIsSmall) {
  if (!HoldsToTimes()) GTEST_SKIP() << "only with BALLPISTON_TORTURE";
  Findings findings("overhead");
  Measure(1, "1 worker", findings);
  Measure(2, "2 workers", findings);
}

}  // namespace
}  // namespace ballpiston::torture
