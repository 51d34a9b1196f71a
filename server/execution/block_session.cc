#include "server/execution/block_session.h"

#include <utility>

#include "server/processor_time.h"

namespace ballpiston::server {
namespace {

constexpr std::chrono::milliseconds kTurn(50);

}  // namespace

BlockSession::BlockSession(BlockExchange& exchange,
                           std::shared_ptr<const PointExperiment> experiment, std::stop_token stop)
    : exchange_(exchange), experiment_(std::move(experiment)), stop_(std::move(stop)) {}

bool BlockSession::Advance() {
  end_of_turn_ = Clock::now() + kTurn;
  worked_ = ThreadSeconds();
  if (blocks_ == nullptr) blocks_ = experiment_->StartRun(*this);
  const bool is_idle = blocks_->Advance();
  exchange_.TurnEnds(ThreadSeconds() - worked_);
  return !is_idle && !stop_.stop_requested();
}

void BlockSession::Done(const Block& block, BlockResult result) {
  const double now = ThreadSeconds();
  exchange_.BlockDone(block, std::move(result), now - std::exchange(worked_, now));
}

bool BlockSession::Pause() { return stop_.stop_requested() || Clock::now() >= end_of_turn_; }

}  // namespace ballpiston::server
