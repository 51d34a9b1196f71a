// Fair-share scheduling. Every principal with active runs gets an equal share of compute time,
// however many runs it has. Among the runs of a principal, higher priorities come first, and runs
// of equal priority get equal shares.
//
// At both levels the entry with the least compute time comes first. Ties go to the older run, or to
// the principal whose name sorts first. A task (a turn at a point, or the opening of a point) is
// charged when it begins, at the mean cost of earlier tasks; otherwise every idle worker would
// choose the same run. When the task ends, the true cost replaces the charge. A new principal or
// run starts at the least charge of those present: it does not wait for the others, and the others
// do not wait until it has caught up. A principal or run that has no task when its turn comes is
// raised in the same way: it gets no credit for time that it could not use. A principal that leaves
// with more compute time than others and returns keeps the difference; otherwise a sequence of
// short jobs would get more time than one long job.
//
// A choice takes the time of a look-up, plus the time to skip runs without a task. For the threads
// there are no more such runs than threads, because threads hold all work of such a run. For an
// executor elsewhere every small run is such a run. Properties, each with a test of its name:
//   1. PrincipalsGetEqualTimeWhateverTheirJobs.
//   2. AHigherPriorityGoesFirstWithinItsPrincipal.
//   3. APriorityDoesNotTakeFromOtherPrincipals.
//   4. ANewRunStartsAtTheLeastCharge.
//   5. UnusedTimeGivesNoCredit.
//   6. AReturningPrincipalKeepsItsLead.
//   7. AChangedPriorityCountsFromTheNextTurn.
// Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace ballpiston::server {

class FairShare {
 public:
  // `run`: greater for a newer one.
  void Add(int64_t run, const std::string& principal, int32_t priority);
  void Remove(int64_t run);
  // Takes effect at the next turn. Ignored if the run is not present.
  void SetPriority(int64_t run, int32_t priority);

  // The first run in the order of turns for which `has_task` is true. Calls `has_task` for one run
  // after the other until it returns true.
  template <typename HasTask>
  std::optional<int64_t> First(HasTask has_task) const;

  // A task of the run that First returned begins, so the runs before it had no task.
  void TurnBegins(int64_t run);
  // A task ends. TurnEnds and Used are ignored if the run is not present.
  void TurnEnds(int64_t run, double seconds);
  // A run has used more time in a turn that goes on.
  void Used(int64_t run, double seconds);

 private:
  struct Share {
    double used = 0;   // seconds, from the starting point
    double spent = 0;  // seconds, by its own tasks
    double turns_ended = 0;
    double turns_in_flight = 0;

    double Charge() const;
    void RaiseTo(double charge) { used += charge - Charge(); }
    void Use(double seconds) { used += seconds, spent += seconds; }
  };

  // Entries that take turns, the one with the least charge first.
  template <typename Key>
  class Turns {
   public:
    const std::set<std::pair<double, Key>>& order() const { return order_; }
    bool empty() const { return order_.empty(); }
    double LeastCharge() const { return empty() ? 0 : order_.begin()->first; }

    void Insert(const Key& key, const Share& share) {
      shares_.emplace(key, share);
      order_.emplace(share.Charge(), key);
    }

    Share Extract(const Key& key) {
      const Share share = shares_.extract(key).mapped();
      order_.erase({share.Charge(), key});
      return share;
    }

    template <typename Change>
    void Update(const Key& key, Change change) {
      Share share = Extract(key);
      change(share);
      Insert(key, share);
    }

    // Raises the entries before this one to its charge. All of them are found before one is
    // raised, because rounding may leave a raised charge just below the mark.
    void RaiseThoseBefore(const Key& key) {
      const double charge = shares_.at(key).Charge();
      std::vector<Key> passed;
      for (auto next = order_.begin(); next->first < charge; ++next) passed.push_back(next->second);
      for (const Key& each : passed) {
        Update(each, [charge](Share& share) { share.RaiseTo(charge); });
      }
    }

   private:
    std::map<Key, Share> shares_;
    std::set<std::pair<double, Key>> order_;  // by charge
  };

  // A run is compared only with runs of its own principal and priority.
  struct Place {
    std::string principal;
    int64_t rank = 0;  // a higher priority has a smaller rank
  };
  using RunsByRank = std::map<int64_t, Turns<int64_t>>;

  void Enter(const std::string& principal);
  void Leave(const std::string& principal);
  void Join(int64_t run, const Place& place, Share share);
  Share Part(int64_t run, const Place& place);
  // Changes the shares of the run and of its principal.
  template <typename Change>
  void Update(int64_t run, Change change);

  std::unordered_map<int64_t, Place> places_;  // by run
  std::map<std::string, RunsByRank> runs_;     // by principal, which has runs
  Turns<std::string> principals_;
  std::map<std::string, double> ahead_;  // charges of principals that left with more than others
};

template <typename HasTask>
std::optional<int64_t> FairShare::First(HasTask has_task) const {
  for (const auto& [principals_charge, principal] : principals_.order()) {
    for (const auto& [rank, turns] : runs_.at(principal)) {
      for (const auto& [charge, run] : turns.order()) {
        if (has_task(run)) return run;
      }
    }
  }
  return std::nullopt;
}

}  // namespace ballpiston::server
