#include "server/compute/fair_share.h"

#include <limits>
#include <vector>

namespace ballpiston::server {
namespace {

// The assumed cost before a run has had a turn: the nominal length of a turn (thread_executor.cc).
constexpr double kExpectedTurnSeconds = 0.05;

}  // namespace

double FairShare::Share::Charge() const {
  const double mean = turns_ended > 0 ? spent / turns_ended : kExpectedTurnSeconds;
  return used + turns_in_flight * mean;
}

std::set<FairShare::Place>::const_iterator FairShare::FirstOf(int64_t rank,
                                                              const std::set<Place>& turns) {
  return turns.lower_bound({.rank = rank,
                            .charge = -std::numeric_limits<double>::infinity(),
                            .run = std::numeric_limits<int64_t>::min()});
}

template <typename Change>
void FairShare::ChangeRun(int64_t run, Change change) {
  RunShare& share = runs_.find(run)->second;
  std::set<Place>& turns = share.principal->second.turns;
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

// ---- principals and runs ----

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
  if (order_.empty()) ahead_.clear();  // no other principal is present to compare with
  principals_.erase(principal);
}

void FairShare::Add(int64_t run, const std::string& principal, int32_t priority) {
  if (runs_.contains(run)) return;
  RunShare added{.principal = Enter(principal), .rank = -int64_t{priority}, .time = {}};
  Join(run, added);
  runs_.emplace(run, added);
}

// A run is compared only with runs of its own priority.
void FairShare::Join(int64_t run, RunShare& share) {
  std::set<Place>& turns = share.principal->second.turns;
  const auto least = FirstOf(share.rank, turns);
  if (least != turns.end() && least->rank == share.rank) share.time.RaiseTo(least->charge);
  turns.insert({share.rank, share.time.Charge(), run});
}

void FairShare::SetPriority(int64_t run, int32_t priority) {
  const auto found = runs_.find(run);
  if (found == runs_.end() || found->second.rank == -int64_t{priority}) return;
  RunShare& share = found->second;
  share.principal->second.turns.erase({share.rank, share.time.Charge(), run});
  share.rank = -int64_t{priority};
  Join(run, share);
}

void FairShare::Remove(int64_t run) {
  const auto found = runs_.find(run);
  if (found == runs_.end()) return;
  const RunShare removed = found->second;
  runs_.erase(found);
  removed.principal->second.turns.erase({removed.rank, removed.time.Charge(), run});
  ChangePrincipal(removed.principal->first,
                  [&](Share& time) { time.turns_in_flight -= removed.time.turns_in_flight; });
  if (removed.principal->second.turns.empty()) Leave(removed.principal);
}

// ---- used time ----

// First finds all, then raises one after the other, because rounding may leave a raised charge just
// below the mark.
void FairShare::RaisePrincipalsBelow(double charge) {
  std::vector<std::string> passed;
  for (auto next = order_.begin(); next->first < charge; ++next) passed.push_back(next->second);
  for (const std::string& name : passed) {
    ChangePrincipal(name, [charge](Share& time) { time.RaiseTo(charge); });
  }
}

void FairShare::RaiseRunsBefore(const Place& place, const std::set<Place>& turns) {
  std::vector<int64_t> passed;
  for (auto next = FirstOf(place.rank, turns); next->charge < place.charge; ++next) {
    passed.push_back(next->run);
  }
  for (const int64_t run : passed) {
    ChangeRun(run, [&](Share& time) { time.RaiseTo(place.charge); });
  }
}

void FairShare::TurnBegins(int64_t run) {
  const auto found = runs_.find(run);
  if (found == runs_.end()) return;
  const auto& [name, principal] = *found->second.principal;
  RaisePrincipalsBelow(principal.time.Charge());
  RaiseRunsBefore({found->second.rank, found->second.time.Charge(), run}, principal.turns);
  const auto begin = [](Share& time) { time.turns_in_flight += 1; };
  ChangeRun(run, begin);
  ChangePrincipal(name, begin);
}

void FairShare::Used(int64_t run, double seconds) {
  const auto found = runs_.find(run);
  if (found == runs_.end()) return;
  const auto use = [seconds](Share& time) {
    time.used += seconds;
    time.spent += seconds;
  };
  ChangeRun(run, use);
  ChangePrincipal(found->second.principal->first, use);
}

void FairShare::TurnEnds(int64_t run, double seconds) {
  const auto found = runs_.find(run);
  if (found == runs_.end()) return;
  const auto end = [seconds](Share& time) {
    time.turns_in_flight -= 1;
    time.turns_ended += 1;
    time.used += seconds;
    time.spent += seconds;
  };
  ChangeRun(run, end);
  ChangePrincipal(found->second.principal->first, end);
}

}  // namespace ballpiston::server
