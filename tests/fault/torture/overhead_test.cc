// What the service costs above the engine that it runs.
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/experiment/point_experiment.h"
#include "core/method_comparison/processor_time.h"
#include "server/convert/spec.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/server_process.h"
#include "tests/fault/torture/sizes.h"
#include "tests/fault/torture/windows.h"

namespace ballpiston::torture {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kMostOverhead = 0.02;
// Enough in a window that the one which is cut short at its end does not matter.
constexpr double kBlocksInWindow = 10;

// The point's blocks, computed by so many threads and merged in order, and nothing else.
class BareEngine {
 public:
  BareEngine(const v1::EnsembleSpec& message, int workers)
      : experiment_(PointExperiment::Create(server::CheckSpec(message).spec, 0)),
        workers_(workers) {}

  Window Run(std::chrono::milliseconds length) {
    window_ = {};
    const auto start = Clock::now();
    std::vector<std::thread> threads;
    for (int i = 0; i < workers_; ++i) threads.emplace_back([&] { Work(start + length); });
    for (std::thread& thread : threads) thread.join();
    window_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return window_;
  }

  double SamplesOfBlock() const {
    return static_cast<double>(merged_.samples) / static_cast<double>(merged_blocks_);
  }

 private:
  void Work(Clock::time_point end) {
    const double start = ThreadSeconds();
    do {
      const uint64_t block = Next();
      Merge(block, *experiment_->RunBlock(block, {}));
    } while (Clock::now() < end);
    const std::lock_guard lock(mutex_);
    window_.processor_seconds += ThreadSeconds() - start;
  }

  uint64_t Next() {
    const std::lock_guard lock(mutex_);
    return next_++;
  }

  void Merge(uint64_t block, BlockResult result) {
    const std::lock_guard lock(mutex_);
    window_.samples += static_cast<double>(result.samples);
    early_.emplace(block, std::move(result));
    while (!early_.empty() && early_.begin()->first == merged_blocks_) {
      merged_.Merge(early_.begin()->second);
      early_.erase(early_.begin());
      ++merged_blocks_;
    }
  }

  const std::unique_ptr<const PointExperiment> experiment_;
  const int workers_;
  std::mutex mutex_;
  uint64_t next_ = 0, merged_blocks_ = 0;
  std::map<uint64_t, BlockResult> early_;
  BlockResult merged_;
  Window window_;
};

// Whatever this thread begins meanwhile, programs and threads, runs on so many cores: neighbours
// slow one core more than another.
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

// The same question to both, in turn: while one computes the other is stopped.
void Compare(int workers, const std::string& name, Findings& findings) {
  const OnFirstCores pinned(workers);
  const v1::EnsembleSpec question = Endless();
  BareEngine engine(question, workers);
  ServerProcess server({.workers = workers});
  server.Start();
  const client::EnsembleClient client(server.Connect());
  const auto job = client.Create(question);
  ASSERT_TRUE(job.ok()) << job.status();
  const std::chrono::milliseconds length(300);
  engine.Run(length);  // both warm
  ServerWindow(server, client, job->name(), length);
  const double least = kBlocksInWindow * engine.SamplesOfBlock();
  PairedRatio processor, wall;
  for (int i = 0; i < Size(4, 400); ++i) {
    const Window with = ServerWindow(server, client, job->name(), length, least);
    server.Signal(SIGSTOP);
    const Window bare = engine.Run(length);
    server.Signal(SIGCONT);
    processor.Add(with.ProcessorCost(), bare.ProcessorCost());
    wall.Add(with.Cost(), bare.Cost());
    findings.Count("pairs of windows");
  }
  findings.Note("processor time a sample, " + name, processor.Text());
  findings.Note("time a sample, " + name, wall.Text());
  const double bound = HoldsToTimes() ? kMostOverhead + 2 * processor.StandardError() : 1;
  EXPECT_LT(processor.ratio() - 1, bound) << name;
  if (HoldsToTimes()) {
    EXPECT_LT(processor.StandardError(), kMostOverhead / 2) << "too noisy to tell";
  }
}

TEST(Overhead, OfTheServiceOverTheBareEngineIsSmall) {
  Findings findings("overhead");
  Compare(1, "1 worker", findings);
  Compare(2, "2 workers", findings);
}

}  // namespace
}  // namespace ballpiston::torture
