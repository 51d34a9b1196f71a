#include "server/compute/fair_share.h"

namespace ballpiston::server {
namespace {

// The assumed cost before a run has had a turn: the nominal length of a turn (thread_executor.cc).
constexpr double kExpectedTurnSeconds = 0.05;

}  // namespace

double FairShare::Share::Charge() const {
  const double mean = turns_ended > 0 ? spent / turns_ended : kExpectedTurnSeconds;
  return used + turns_in_flight * mean;
}

// ---- principals and runs ----

void FairShare::Enter(const std::string& principal) {
  const double least = principals_.LeastCharge();
  std::erase_if(ahead_, [least](const auto& entry) { return entry.second <= least; });
  const auto ahead = ahead_.extract(principal);
  principals_.Insert(principal, {.used = ahead.empty() ? least : ahead.mapped()});
}

void FairShare::Leave(const std::string& principal) {
  const double charge = principals_.Extract(principal).Charge();
  if (charge > principals_.LeastCharge()) ahead_[principal] = charge;
  if (principals_.empty()) ahead_.clear();  // no other principal is present to compare with
}

void FairShare::Join(int64_t run, const Place& place, Share share) {
  Turns<int64_t>& turns = runs_[place.principal][place.rank];
  if (!turns.empty()) share.RaiseTo(turns.LeastCharge());
  turns.Insert(run, share);
  places_[run] = place;
}

FairShare::Share FairShare::Part(int64_t run, const Place& place) {
  RunsByRank& ranks = runs_.at(place.principal);
  const auto turns = ranks.find(place.rank);
  const Share share = turns->second.Extract(run);
  if (turns->second.empty()) ranks.erase(turns);
  return share;
}

void FairShare::Add(int64_t run, const std::string& principal, int32_t priority) {
  if (places_.contains(run)) return;
  if (!runs_.contains(principal)) Enter(principal);
  Join(run, {principal, -int64_t{priority}}, Share());
}

void FairShare::SetPriority(int64_t run, int32_t priority) {
  const auto found = places_.find(run);
  if (found == places_.end() || found->second.rank == -int64_t{priority}) return;
  const Place before = found->second;
  Join(run, {before.principal, -int64_t{priority}}, Part(run, before));
}

void FairShare::Remove(int64_t run) {
  const auto found = places_.extract(run);
  if (found.empty()) return;
  const std::string& principal = found.mapped().principal;
  const Share removed = Part(run, found.mapped());
  principals_.Update(principal,
                     [&](Share& share) { share.turns_in_flight -= removed.turns_in_flight; });
  if (!runs_.at(principal).empty()) return;
  runs_.erase(principal);
  Leave(principal);
}

// ---- used time ----

template <typename Change>
void FairShare::Update(int64_t run, Change change) {
  const auto found = places_.find(run);
  if (found == places_.end()) return;
  const auto& [principal, rank] = found->second;
  runs_.at(principal).at(rank).Update(run, change);
  principals_.Update(principal, change);
}

void FairShare::TurnBegins(int64_t run) {
  const auto& [principal, rank] = places_.at(run);
  principals_.RaiseThoseBefore(principal);
  runs_.at(principal).at(rank).RaiseThoseBefore(run);
  Update(run, [](Share& share) { share.turns_in_flight += 1; });
}

void FairShare::Used(int64_t run, double seconds) {
  Update(run, [seconds](Share& share) { share.Use(seconds); });
}

void FairShare::TurnEnds(int64_t run, double seconds) {
  Update(run, [seconds](Share& share) {
    share.turns_in_flight -= 1;
    share.turns_ended += 1;
    share.Use(seconds);
  });
}

}  // namespace ballpiston::server
