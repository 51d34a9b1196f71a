#include "server/compute/held_leases.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace ballpiston::server {
namespace {

// Leases with all the rest of a point, which may last for hours, take at most this share of the
// memory together. So a run that waits for memory seldom waits for one of them.
constexpr double kShareOfTheRest = 0.25;

// The share of the memory that a principal with other leases may take.
constexpr double kShareOfAll = 0.75;

}  // namespace

// ---- leases ----

HeldLeases::Held& HeldLeases::Add(Lease lease, Owner owner) {
  lease.number = ++last_number_;
  if (lease.local) ++local_leases_[owner];
  const Key key = KeyOf(lease);
  return held_.emplace(key, Held{std::move(lease), std::move(owner)}).first->second;
}

HeldLeases::Held* HeldLeases::FirstWithTurn(int64_t run) {
  Held* first = nullptr;
  const auto end = held_.lower_bound(FirstOf(run, false));
  for (auto next = held_.lower_bound(FirstOf(run, true)); next != end; ++next) {
    Held& held = next->second;
    const Lease& lease = held.lease;
    const Owner lowest = {held.owner.first, std::numeric_limits<int32_t>::min()};
    const bool has_memory =
        held.turns < held.most_turns ||
        lease.memory.of_a_further_turn <= FreeMemory(IsLater(lease), HasMoreThan(1, lowest));
    if (lease.stop.stop_requested() || !has_memory) continue;
    if (first != nullptr && lease.point >= first->lease.point) continue;
    if (lease.work->HasTurn()) first = &held;
  }
  return first;
}

const Lease& HeldLeases::BeginTurn(Held& held) {
  const LeaseMemory& memory = held.lease.memory;
  if (++held.turns > held.most_turns) {
    AddMemory(held.lease, held.turns == 1 ? memory.of_one_turn : memory.of_a_further_turn);
    held.most_turns = held.turns;
  }
  return held.lease;
}

void HeldLeases::EndTurn(const Lease& lease) {
  const auto held = held_.find(KeyOf(lease));
  const bool is_last = --held->second.turns == 0;
  if (is_last && (lease.stop.stop_requested() || !lease.work->HasTurn())) Drop(held);
}

bool HeldLeases::HasLocal(int64_t run) const {
  return held_.lower_bound(FirstOf(run, true)) != held_.lower_bound(FirstOf(run, false));
}

std::vector<Lease> HeldLeases::RemoveStopped(int64_t run) {
  std::vector<Lease> removed;
  auto next = held_.lower_bound(FirstOf(run, true));
  for (const auto end = held_.lower_bound(FirstOf(run + 1, true)); next != end;) {
    const Lease& lease = next->second.lease;
    const bool drops = lease.stop.stop_requested() && !(lease.local && next->second.turns > 0);
    if (drops) removed.push_back(lease);
    next = drops ? Drop(next) : std::next(next);
  }
  return removed;
}

HeldLeases::Leases::iterator HeldLeases::Drop(Leases::iterator held) {
  const auto& [lease, owner, turns, most_turns] = held->second;
  if (lease.local && --local_leases_[owner] == 0) local_leases_.erase(owner);
  AddMemory(lease, -lease.memory.of_one_turn - (most_turns - 1) * lease.memory.of_a_further_turn);
  return held_.erase(held);
}

// ---- memory ----

Capacity HeldLeases::WithMemory(Capacity capacity, int64_t run, const Owner& owner) const {
  const bool another_waits = waiting_ && waiting_->run != run;
  if (another_waits || memory_ > 0) {
    capacity.memory = FreeMemory(another_waits, HasMoreThan(0, owner));
  }
  capacity.memory_of_the_rest = kShareOfTheRest * limit_ - memory_;
  return capacity;
}

bool HeldLeases::HasMoreThan(int leases, const Owner& owner) const {
  auto next = local_leases_.lower_bound(owner);
  for (; next != local_leases_.end() && next->first.first == owner.first; ++next) {
    leases -= next->second;
  }
  return leases < 0;
}

// Bytes that a lease of a local executor can still take. `is_later`: it began after a run began to
// wait, which may have other leases.
double HeldLeases::FreeMemory(bool is_later, bool has_other_leases) const {
  const double share = kShareOfAll * limit_;
  const double free = (has_other_leases ? share : limit_) - memory_;
  return is_later ? std::min(free, share - waiting_->memory - waiting_->later) : free;
}

bool HeldLeases::IsLater(const Lease& lease) const {
  return waiting_ && lease.number > waiting_->last_lease;
}

void HeldLeases::AddMemory(const Lease& lease, double bytes) {
  memory_ += bytes;
  if (IsLater(lease)) waiting_->later += bytes;
}

void HeldLeases::NoteAwaited(int64_t run, double memory) {
  const double needed = HasLocal(run) ? 0 : memory;
  if (needed > 0 && !waiting_) waiting_ = {run, needed, last_number_};
  if (needed == 0) EndWaiting(run);
}

bool HeldLeases::EndWaiting(int64_t run) {
  const bool waits = waiting_ && waiting_->run == run;
  if (waits) waiting_.reset();
  return waits;
}

}  // namespace ballpiston::server
