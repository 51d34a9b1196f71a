#include "server/execution/fair_share.h"

namespace ballpiston::server {
namespace {

// Until a run has finished a block; what a plan of blocks aims at.
constexpr double kExpectedBlockSeconds = 0.1;

}  // namespace

double FairShare::Share::Charge() const {
  const double mean = blocks_ended > 0 ? spent / blocks_ended : kExpectedBlockSeconds;
  return used + blocks_in_flight * mean;
}

template <typename Change>
void FairShare::Reorder(int64_t run, Change change) {
  const auto share = shares_.find(run);
  if (share == shares_.end()) return;
  order_.erase({share->second.Charge(), run});
  change(share->second);
  order_.insert({share->second.Charge(), run});
}

void FairShare::Add(int64_t run) {
  Share share;
  if (!order_.empty()) share.used = order_.begin()->first;
  if (shares_.emplace(run, share).second) order_.insert({share.Charge(), run});
}

void FairShare::Remove(int64_t run) {
  const auto share = shares_.find(run);
  if (share == shares_.end()) return;
  order_.erase({share->second.Charge(), run});
  shares_.erase(share);
}

void FairShare::BlockBegins(int64_t run) {
  Reorder(run, [](Share& share) { share.blocks_in_flight += 1; });
}

void FairShare::BlockEnds(int64_t run, double seconds) {
  Reorder(run, [seconds](Share& share) {
    share.blocks_in_flight -= 1;
    share.blocks_ended += 1;
    share.used += seconds;
    share.spent += seconds;
  });
}

}  // namespace ballpiston::server
