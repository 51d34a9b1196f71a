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

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>

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

  // A task of the run begins or ends; ignored if the run is not present. A task begins only for the
  // run that First returned, so the runs before it had no task.
  void TurnBegins(int64_t run);
  void TurnEnds(int64_t run, double seconds);

  // A run has used more time in a turn that goes on.
  void Used(int64_t run, double seconds);

  size_t runs() const { return runs_.size(); }

 private:
  struct Share {
    double used = 0;   // seconds, from the starting point
    double spent = 0;  // seconds, by its own tasks
    double turns_ended = 0;
    double turns_in_flight = 0;

    double Charge() const;
    void RaiseTo(double charge) { used += charge - Charge(); }
  };

  struct Place {
    int64_t rank = 0;  // a higher priority has a smaller rank
    double charge = 0;
    int64_t run = 0;

    auto operator<=>(const Place&) const = default;
  };

  struct PrincipalShare {
    Share time;
    std::set<Place> turns;
  };

  using Principals = std::map<std::string, PrincipalShare>;

  struct RunShare {
    Principals::iterator principal;
    int64_t rank = 0;
    Share time;
  };

  Principals::iterator Enter(const std::string& principal);
  void Leave(Principals::iterator principal);
  double LeastCharge() const { return order_.empty() ? 0 : order_.begin()->first; }

  // The least turn of that rank, or the first of the next.
  static std::set<Place>::const_iterator FirstOf(int64_t rank, const std::set<Place>& turns);

  // Adds the run to the turns of its principal, at the least charge of its rank.
  void Join(int64_t run, RunShare& share);

  // Change a share, and keep the order in step with it.
  template <typename Change>
  void ChangeRun(int64_t run, Change change);
  template <typename Change>
  void ChangePrincipal(const std::string& principal, Change change);

  void RaisePrincipalsBelow(double charge);
  void RaiseRunsBefore(const Place& place, const std::set<Place>& turns);

  std::unordered_map<int64_t, RunShare> runs_;
  Principals principals_;  // with runs
  std::set<std::pair<double, std::string>> order_;
  std::map<std::string, double> ahead_;  // charges of principals that left with more than others
};

template <typename HasTask>
std::optional<int64_t> FairShare::First(HasTask has_task) const {
  for (const auto& [charge, name] : order_) {
    for (const Place& place : principals_.find(name)->second.turns) {
      if (has_task(place.run)) return place.run;
    }
  }
  return std::nullopt;
}

}  // namespace ballpiston::server
