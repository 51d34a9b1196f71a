#include "server/execution/comparison_thread.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <utility>

namespace ballpiston::server {

ComparisonThread::ComparisonThread(MethodComparer compare)
    : compare_(std::move(compare)), thread_([this] { Work(); }) {}

ComparisonThread::~ComparisonThread() { Stop(); }

ComparisonThread::Admission ComparisonThread::Begin(Comparison comparison) {
  std::unique_lock lock(mutex_);
  if (stopping_) return Admission::kStopped;
  const std::deque<Comparison> abandoned = TakeAbandoned();
  const bool busy = Has(comparison.principal);
  if (!busy) waiting_.push_back(std::move(comparison));
  changed_.notify_one();
  lock.unlock();
  for (const Comparison& left : abandoned) left.ended(absl::CancelledError("stopped"));
  return busy ? Admission::kBusy : Admission::kBegun;
}

bool ComparisonThread::Has(const std::string& principal) const {
  const auto is_its = [&](const Comparison& one) { return one.principal == principal; };
  return (running_ && is_its(*running_)) || std::ranges::any_of(waiting_, is_its);
}

// Those that wait and were stopped: nobody wants them any more.
std::deque<Comparison> ComparisonThread::TakeAbandoned() {
  const auto first =
      std::stable_partition(waiting_.begin(), waiting_.end(),
                            [](const Comparison& one) { return !one.stop.stop_requested(); });
  std::deque<Comparison> abandoned(std::make_move_iterator(first),
                                   std::make_move_iterator(waiting_.end()));
  waiting_.erase(first, waiting_.end());
  return abandoned;
}

void ComparisonThread::AskToStop() {
  std::lock_guard lock(mutex_);
  stopping_ = true;
  if (running_) running_->stop.request_stop();
  for (Comparison& one : waiting_) one.stop.request_stop();
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

// A copy, because Stop reads the one in `running_`. After a stop those that waited have their turn,
// too: they are stopped, and end at once.
std::optional<Comparison> ComparisonThread::AwaitComparison() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
  if (waiting_.empty()) return std::nullopt;
  running_ = std::move(waiting_.front());
  waiting_.pop_front();
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
