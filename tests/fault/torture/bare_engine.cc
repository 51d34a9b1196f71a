#include "tests/fault/torture/bare_engine.h"

#include <signal.h>

#include <thread>
#include <utility>
#include <vector>

#include "core/method_comparison/processor_time.h"
#include "server/convert/spec.h"

namespace ballpiston::torture {

BareEngine::BareEngine(const v1::EnsembleSpec& question, int workers)
    : experiment_(PointExperiment::Create(server::CheckSpec(question).spec, 0)),
      workers_(workers) {}

Window BareEngine::Run(std::chrono::milliseconds length) {
  window_ = {};
  const auto start = Clock::now();
  std::vector<std::thread> threads;
  for (int i = 0; i < workers_; ++i) threads.emplace_back([&] { Work(start + length); });
  for (std::thread& thread : threads) thread.join();
  window_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return window_;
}

Window BareEngine::RunInsteadOf(const ServerProcess& server, std::chrono::milliseconds length) {
  server.Signal(SIGSTOP);
  const Window window = Run(length);
  server.Signal(SIGCONT);
  return window;
}

double BareEngine::SamplesOfBlock() const {
  return static_cast<double>(merged_.samples) / static_cast<double>(merged_blocks_);
}

void BareEngine::Work(Clock::time_point end) {
  const double start = ThreadSeconds();
  do {
    const uint64_t block = Next();
    Merge(block, *experiment_->RunBlock(block, {}));
  } while (Clock::now() < end);
  const std::lock_guard lock(mutex_);
  window_.processor_seconds += ThreadSeconds() - start;
}

uint64_t BareEngine::Next() {
  const std::lock_guard lock(mutex_);
  return next_++;
}

void BareEngine::Merge(uint64_t block, BlockResult result) {
  const std::lock_guard lock(mutex_);
  window_.samples += static_cast<double>(result.samples);
  early_.emplace(block, std::move(result));
  while (!early_.empty() && early_.begin()->first == merged_blocks_) {
    merged_.Merge(early_.begin()->second);
    early_.erase(early_.begin());
    ++merged_blocks_;
  }
}

}  // namespace ballpiston::torture
