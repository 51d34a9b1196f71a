#include "server/execution/fair_share.h"

#include <limits>
#include <vector>

namespace ballpiston::server {
namespace {

// Until a run has finished a block; what a plan of blocks aims at.
constexpr double kExpectedBlockSeconds = 0.1;

}  // namespace

double FairShare::Share::Charge() const {
  const double mean = blocks_ended > 0 ? spent / blocks_ended : kExpectedBlockSeconds;
  return used + blocks_in_flight * mean;
}

std::set<FairShare::Turn>::const_iterator FairShare::FirstOf(int64_t rank,
                                                             const std::set<Turn>& turns) {
  return turns.lower_bound({.rank = rank,
                            .charge = -std::numeric_limits<double>::infinity(),
                            .run = std::numeric_limits<int64_t>::min()});
}

template <typename Change>
void FairShare::ChangeRun(int64_t run, Change change) {
  RunShare& share = runs_.find(run)->second;
  std::set<Turn>& turns = share.principal->second.turns;
  turns.erase({share.rank, share.time.Charge(), run});
  change(share.time);
  turns.insert({share.rank, share.time.Charge(), run});
}

template <typename Change>
void FairShare::ChangePrincipal(const std::string& principal, Change change) {
  Share& time = principals_.find(principal)->second.time;
  order_.erase({time.Charge(), principal});
  change(time);
  order_.insert({time.Charge(), principal});
}

// ---- who is there ----

FairShare::Principals::iterator FairShare::Enter(const std::string& name) {
  const auto [principal, is_new] = principals_.try_emplace(name);
  if (!is_new) return principal;
  const double least = LeastCharge();
  std::erase_if(ahead_, [least](const auto& entry) { return entry.second <= least; });
  const auto ahead = ahead_.extract(name);
  principal->second.time.used = ahead.empty() ? least : ahead.mapped();
  order_.insert({principal->second.time.Charge(), name});
  return principal;
}

void FairShare::Leave(Principals::iterator principal) {
  const double charge = principal->second.time.Charge();
  order_.erase({charge, principal->first});
  if (charge > LeastCharge()) ahead_[principal->first] = charge;
  if (order_.empty()) ahead_.clear();  // nobody is left to be ahead of
  principals_.erase(principal);
}

void FairShare::Add(int64_t run, const std::string& principal, int32_t priority) {
  if (runs_.contains(run)) return;
  RunShare added{.principal = Enter(principal), .rank = -int64_t{priority}, .time = {}};
  std::set<Turn>& turns = added.principal->second.turns;
  // Compared with none but those of its own priority.
  const auto least = FirstOf(added.rank, turns);
  if (least != turns.end() && least->rank == added.rank) added.time.used = least->charge;
  turns.insert({added.rank, added.time.Charge(), run});
  runs_.emplace(run, added);
}

void FairShare::Remove(int64_t run) {
  const auto found = runs_.find(run);
  if (found == runs_.end()) return;
  const RunShare removed = found->second;
  runs_.erase(found);
  removed.principal->second.turns.erase({removed.rank, removed.time.Charge(), run});
  ChangePrincipal(removed.principal->first,
                  [&](Share& time) { time.blocks_in_flight -= removed.time.blocks_in_flight; });
  if (removed.principal->second.turns.empty()) Leave(removed.principal);
}

// ---- what they use ----

// First all, then one after the other: a charge that was raised may miss its mark by a rounding.
void FairShare::RaisePrincipalsBelow(double charge) {
  std::vector<std::string> passed;
  for (auto next = order_.begin(); next->first < charge; ++next) passed.push_back(next->second);
  for (const std::string& name : passed) {
    ChangePrincipal(name, [charge](Share& time) { time.RaiseTo(charge); });
  }
}

void FairShare::RaiseRunsBefore(const Turn& turn, const std::set<Turn>& turns) {
  std::vector<int64_t> passed;
  for (auto next = FirstOf(turn.rank, turns); next->charge < turn.charge; ++next) {
    passed.push_back(next->run);
  }
  for (const int64_t run : passed) {
    ChangeRun(run, [&](Share& time) { time.RaiseTo(turn.charge); });
  }
}

void FairShare::BlockBegins(int64_t run) {
  const auto found = runs_.find(run);
  if (found == runs_.end()) return;
  const auto& [name, principal] = *found->second.principal;
  RaisePrincipalsBelow(principal.time.Charge());
  RaiseRunsBefore({found->second.rank, found->second.time.Charge(), run}, principal.turns);
  const auto begin = [](Share& time) { time.blocks_in_flight += 1; };
  ChangeRun(run, begin);
  ChangePrincipal(name, begin);
}

void FairShare::BlockEnds(int64_t run, double seconds) {
  const auto found = runs_.find(run);
  if (found == runs_.end()) return;
  const auto end = [seconds](Share& time) {
    time.blocks_in_flight -= 1;
    time.blocks_ended += 1;
    time.used += seconds;
    time.spent += seconds;
  };
  ChangeRun(run, end);
  ChangePrincipal(found->second.principal->first, end);
}

}  // namespace ballpiston::server
