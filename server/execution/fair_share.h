// Whose turn it is: an even share of compute time for every active run.
//
// The run with the least compute time used comes first; at equality the older one (smaller key). A
// block in flight is charged when it begins, at the mean cost of its run's blocks, or else every
// idle worker would turn to the same run; the charge becomes the true cost when the block ends. A
// new run starts at the least of those present: it neither waits for the others to be served nor
// makes them wait until it has caught up. Property, with a test of its name:
//   1. UnequalBlocksGetEqualTime.
// Not thread-safe.
#ifndef BALLPISTON_SERVER_EXECUTION_FAIR_SHARE_H_
#define BALLPISTON_SERVER_EXECUTION_FAIR_SHARE_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

namespace ballpiston::server {

class FairShare {
 public:
  // (charge in seconds, key of the run), least first.
  using Order = std::set<std::pair<double, int64_t>>;

  void Add(int64_t run);
  void Remove(int64_t run);

  // Of a run that was added and not removed; others are ignored.
  void BlockBegins(int64_t run);
  void BlockEnds(int64_t run, double seconds);

  const Order& order() const { return order_; }

 private:
  struct Share {
    double used = 0;   // seconds, from the starting point given by Add
    double spent = 0;  // seconds, by its own blocks
    double blocks_ended = 0;
    double blocks_in_flight = 0;

    double Charge() const;
  };

  template <typename Change>
  void Reorder(int64_t run, Change change);

  std::map<int64_t, Share> shares_;
  Order order_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_EXECUTION_FAIR_SHARE_H_
