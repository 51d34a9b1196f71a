#include "tests/fault/torture/bare_engine.h"

#include <signal.h>

#include <thread>
#include <utility>

#include "server/convert/spec.h"
#include "server/processor_time.h"

namespace ballpiston::torture {
namespace {

// Blocks of a point that several threads share, until the window ends.
class SharedBlocks : public BlockQueue {
 public:
  SharedBlocks(LocalPoint& point, std::mutex& mutex, Window& window,
               const std::atomic<BareEngine::Clock::time_point>& end)
      : point_(point), mutex_(mutex), window_(window), end_(end) {}

  std::optional<Block> Next() override {
    const std::lock_guard lock(mutex_);
    return point_.NextBlock();
  }
  void Done(const Block& block, BlockResult result) override {
    const std::lock_guard lock(mutex_);
    window_.samples += static_cast<double>(result.samples);
    point_.Add(block, std::move(result));
  }
  bool Pause() override { return BareEngine::Clock::now() >= end_.load(); }
  std::stop_token stop() const override { return {}; }

 private:
  LocalPoint& point_;
  std::mutex& mutex_;
  Window& window_;
  const std::atomic<BareEngine::Clock::time_point>& end_;
};

}  // namespace

BareEngine::BareEngine(const v1::EnsembleSpec& question, int workers)
    : experiment_(PointExperiment::Create(server::CheckSpec(question).spec, 0)),
      point_(*experiment_) {
  for (int i = 0; i < workers; ++i) {
    Worker& worker = workers_.emplace_back();
    worker.queue = std::make_unique<SharedBlocks>(point_, mutex_, window_, end_);
    worker.run = experiment_->StartRun(*worker.queue);
  }
}

Window BareEngine::Run(std::chrono::milliseconds length) {
  window_ = {};
  const auto start = Clock::now();
  end_ = start + length;
  std::vector<std::thread> threads;
  for (Worker& worker : workers_) threads.emplace_back([&] { Work(worker); });
  for (std::thread& thread : threads) thread.join();
  window_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return window_;
}

Window BareEngine::RunInsteadOf(const ServerProcess& server, std::chrono::milliseconds length,
                                double least_samples) {
  server.Signal(SIGSTOP);
  Window window;
  while (window.samples < least_samples) window += Run(length);
  server.Signal(SIGCONT);
  return window;
}

void BareEngine::Work(Worker& worker) {
  const double start = server::ThreadSeconds();
  while (Clock::now() < end_.load()) worker.run->Advance();
  const std::lock_guard lock(mutex_);
  window_.processor_seconds += server::ThreadSeconds() - start;
}

}  // namespace ballpiston::torture
