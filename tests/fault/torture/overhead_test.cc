// The cost of the service compared with the engine alone.
#include <sched.h>

#include <ctime>

#include "tests/fault/torture/costs.h"
#include "tests/fault/torture/preamble.h"
#include "tests/server/running_server.h"

namespace ballpiston::torture {
namespace {

constexpr double kMostOverhead = 0.01;
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

// Of all threads of this process.
double ProcessSeconds() {
  timespec time = {};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Seconds of server and client for a sample, from the creation of the job to its end.
double ServiceCost(server::RunningServer& server, const v1::EnsembleSpec& question) {
  const double start = ProcessSeconds();
  const double samples = server.AwaitEnd(server.Submit(question)).progress().samples();
  return (ProcessSeconds() - start) / samples;
}

// The same question for both in turn. While the engine computes, the server is idle. It is in this
// process, because the same code takes up to 4 % more or less time in another program, where it has
// other addresses.
void Compare(int workers, const std::string& name, Findings& findings) {
  const OnFirstCores pinned(workers);
  const v1::EnsembleSpec question = ManyPoints(1, Size(300'000, 10'000'000));
  server::RunningServer server({.workers = workers, .factory = nullptr, .watch = {}, .store = {}});
  ServiceCost(server, question);  // both warm
  EngineCost(question);
  PairedRatio processor;
  for (int i = 0; i < Size(1, 60); ++i) {
    const double with = ServiceCost(server, question);
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
