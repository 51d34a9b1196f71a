#include "server/execution/comparison_thread.h"

#include <exception>
#include <utility>

namespace ballpiston::server {

ComparisonThread::ComparisonThread(MethodComparer compare)
    : compare_(std::move(compare)), thread_([this] { Work(); }) {}

ComparisonThread::~ComparisonThread() { Stop(); }

ComparisonThread::Admission ComparisonThread::Begin(Comparison comparison) {
  std::lock_guard lock(mutex_);
  if (stopping_) return Admission::kStopped;
  if (running_) return Admission::kBusy;
  running_ = std::move(comparison);
  changed_.notify_one();
  return Admission::kBegun;
}

void ComparisonThread::AskToStop() {
  std::lock_guard lock(mutex_);
  stopping_ = true;
  if (running_) running_->stop.request_stop();
  changed_.notify_one();
}

void ComparisonThread::Stop() {
  AskToStop();
  if (thread_.joinable()) thread_.join();
}

void ComparisonThread::Work() {
  while (const std::optional<Comparison> comparison = AwaitComparison()) {
    const absl::Status status = Compare(*comparison);
    {
      std::lock_guard lock(mutex_);
      running_.reset();
    }
    comparison->ended(status);
  }
}

// A copy, because Stop reads the one in `running_`.
std::optional<Comparison> ComparisonThread::AwaitComparison() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stopping_ || running_; });
  return running_;
}

absl::Status ComparisonThread::Compare(const Comparison& comparison) const {
  try {
    return compare_(comparison.spec, comparison.stop.get_token(), comparison.tell);
  } catch (const std::exception& error) {
    return absl::InternalError(error.what());
  }
}

}  // namespace ballpiston::server
