// The leases that executors have, and the memory that those of local executors take.
//
// The leases of local executors take no more memory together than the limit, unless one does alone.
// The first run that finds too little memory waits: leases of other runs that begin later leave it
// as much as it needs. A quarter of the limit is for leases whose principal has no other one of the
// same or a higher priority, and for further turns of a principal's only lease: otherwise the long
// points of one principal could take all memory. Not thread-safe: the scheduler's lock guards it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "server/compute/lease.h"

namespace ballpiston::server {

class HeldLeases {
 public:
  // A run's principal and priority.
  using Owner = std::pair<std::string, int32_t>;

  struct Held {
    Lease lease;
    Owner owner;
    int turns = 0;       // of a local executor
    int most_turns = 0;  // at a time until now
  };

  // Bytes.
  explicit HeldLeases(double memory_limit) : limit_(memory_limit) {}

  // The capacity of a local executor, with the memory that a new lease of the run can take.
  Capacity WithMemory(Capacity capacity, int64_t run, const Owner& owner) const;

  // Gives the lease, which has chunks, its number.
  Held& Add(Lease lease, Owner owner);

  // The lease whose point comes first, among the run's local leases that have a turn, and for whose
  // turn there is memory. Null if there is none.
  Held* FirstWithTurn(int64_t run);

  // A turn at the lease begins. Returns the lease.
  const Lease& BeginTurn(Held& held);
  // A turn ends. The lease stays while it has a turn in progress, or one that can begin.
  void EndTurn(const Lease& lease);

  bool Has(const Lease& lease) const { return held_.contains(KeyOf(lease)); }
  bool HasLocal(int64_t run) const;  // a lease of a local executor

  // Of an executor that is not local. False if it does not have the lease.
  bool Remove(const Lease& lease) { return held_.erase(KeyOf(lease)) > 0; }
  // Removes and returns the run's leases whose stop was requested and at which no local turn is in
  // progress.
  std::vector<Lease> RemoveStopped(int64_t run);

  // A local executor asked for a lease of the run, which needs so much memory that it got none; or
  // 0. The run keeps its place until it has a lease, or needs none.
  void NoteAwaited(int64_t run, double memory);
  bool OneWaits() const { return waiting_.has_value(); }
  // The run is over. False if it did not wait.
  bool EndWaiting(int64_t run);

 private:
  using Key = std::tuple<int64_t, bool, int64_t>;  // run, not local, number
  using Leases = std::map<Key, Held>;

  // A run that waits for memory.
  struct Waiting {
    int64_t run;
    double memory;       // bytes that it needs
    int64_t last_lease;  // before it waited
    double later = 0;    // bytes of leases that began later
  };

  static Key FirstOf(int64_t run, bool local) { return {run, !local, 0}; }
  static Key KeyOf(const Lease& lease) { return {lease.run, !lease.local, lease.number}; }

  Leases::iterator Drop(Leases::iterator held);
  // Whether the principal has more local leases of this priority or a higher one.
  bool HasMoreThan(int leases, const Owner& owner) const;
  double FreeMemory(bool is_later, bool has_other_leases) const;
  bool IsLater(const Lease& lease) const;
  void AddMemory(const Lease& lease, double bytes);

  const double limit_;
  Leases held_;
  std::map<Owner, int> local_leases_;
  double memory_ = 0;  // bytes that they take
  std::optional<Waiting> waiting_;
  int64_t last_number_ = 0;
};

}  // namespace ballpiston::server
