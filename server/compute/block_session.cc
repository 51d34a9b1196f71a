#include "server/compute/block_session.h"

#include <utility>

#include "server/host.h"

namespace ballpiston::server {
namespace {

constexpr std::chrono::milliseconds kTurn(50);

}  // namespace

BlockSession::BlockSession(BlockExchange& exchange,
                           std::shared_ptr<const PointExperiment> experiment, std::stop_token stop,
                           OrbitDevice* device)
    : exchange_(exchange),
      experiment_(std::move(experiment)),
      stop_(std::move(stop)),
      device_(device) {}

bool BlockSession::Advance() {
  end_of_turn_ = SteadyNow() + kTurn;
  worked_ = ProcessorSeconds();
  if (blocks_ == nullptr) blocks_ = experiment_->StartRun(*this);
  const bool is_idle = blocks_->Advance();
  exchange_.TurnEnds(ProcessorSeconds() - worked_);
  return !is_idle && !stop_.stop_requested();
}

void BlockSession::Done(const Block& block, BlockResult result) {
  const double now = ProcessorSeconds();
  exchange_.BlockDone(block, std::move(result), now - std::exchange(worked_, now));
}

bool BlockSession::Pause() { return stop_.stop_requested() || SteadyNow() >= end_of_turn_; }

}  // namespace ballpiston::server
