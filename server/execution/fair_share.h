// Whose turn it is: an even share of compute time for every principal with active runs, however
// many they are; among a principal's runs the higher priority first, and an even share for those of
// the same.
//
// At both levels the least compute time used comes first, at equality the older run, or the
// principal whose name comes first. A block in flight is charged when it begins, at the mean cost
// of the blocks so far, or else every idle worker would turn to the same run; the charge becomes
// the true cost when the block ends. Who is new starts at the least of those present: it neither
// waits for the others to be served nor makes them wait until it has caught up. The same holds for
// who had nothing to hand out when its turn came: it is not owed what it could not use. A principal
// that leaves ahead of others and comes back is as far ahead, or else a row of short jobs would get
// more than one long one.
//
// A choice takes the time of a look-up, plus that of those who are asked in vain: runs with all of
// their blocks in flight, so no more than there are workers. Properties, with tests of their names:
//   1. UnequalBlocksGetEqualTime.
//   2. PrincipalsGetEqualTimeWhateverTheirJobs.
//   3. AHigherPriorityGoesFirstWithinItsPrincipal.
//   4. APriorityDoesNotTakeFromOtherPrincipals.
//   5. ANewPrincipalNeitherWaitsNorStarves.
//   6. ANewRunStartsAtTheLeastOfThosePresent.
//   7. TimeThatCouldNotBeUsedIsNotOwed.
//   8. APrincipalThatComesBackIsAsFarAhead.
// Not thread-safe.
#ifndef BALLPISTON_SERVER_EXECUTION_FAIR_SHARE_H_
#define BALLPISTON_SERVER_EXECUTION_FAIR_SHARE_H_

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

  // The run whose turn it is, of those for which `has_task` is true; it is asked of one after the
  // other until it is.
  template <typename HasTask>
  std::optional<int64_t> First(HasTask has_task) const;

  // Of a run that was added and not removed; others are ignored. It begins because it was first:
  // those before it had no task.
  void BlockBegins(int64_t run);
  void BlockEnds(int64_t run, double seconds);

  size_t runs() const { return runs_.size(); }

 private:
  struct Share {
    double used = 0;   // seconds, from the starting point
    double spent = 0;  // seconds, by its own blocks
    double blocks_ended = 0;
    double blocks_in_flight = 0;

    double Charge() const;
    void RaiseTo(double charge) { used += charge - Charge(); }
  };

  struct Turn {
    int64_t rank = 0;  // the higher the priority, the less
    double charge = 0;
    int64_t run = 0;

    auto operator<=>(const Turn&) const = default;
  };

  struct PrincipalShare {
    Share time;
    std::set<Turn> turns;
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
  static std::set<Turn>::const_iterator FirstOf(int64_t rank, const std::set<Turn>& turns);

  // Change a share, and keep the order in step with it.
  template <typename Change>
  void ChangeRun(int64_t run, Change change);
  template <typename Change>
  void ChangePrincipal(const std::string& principal, Change change);

  void RaisePrincipalsBelow(double charge);
  void RaiseRunsBefore(const Turn& turn, const std::set<Turn>& turns);

  std::unordered_map<int64_t, RunShare> runs_;
  Principals principals_;  // with runs
  std::set<std::pair<double, std::string>> order_;
  std::map<std::string, double> ahead_;  // charges of principals that left with more than others
};

template <typename HasTask>
std::optional<int64_t> FairShare::First(HasTask has_task) const {
  for (const auto& [charge, name] : order_) {
    for (const Turn& turn : principals_.find(name)->second.turns) {
      if (has_task(turn.run)) return turn.run;
    }
  }
  return std::nullopt;
}

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_EXECUTION_FAIR_SHARE_H_
