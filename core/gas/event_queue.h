// The times of the next events of many bodies, and the earliest of them: a tournament. Every match
// has two players, bodies or winners of matches, and is won by the earlier event. Bodies with equal
// times come in the order of their numbers.
//
// A new time of a body is played up to the final. The opponents on this way do not depend on the
// results, so a processor loads them all at once; a heap would wait for each comparison.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace ballpiston {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

class EventQueue {
 public:
  // No body has an event. Requires bodies > 0.
  explicit EventQueue(size_t bodies) : bodies_(bodies), entries_(2 * bodies) {}

  struct Entry {
    double time = kNever;
    uint32_t body = 0;

    // & instead of &&, because the processor often predicts a branch on the result wrongly.
    bool IsBefore(const Entry& other) const {
      return (int{time < other.time} | (int{time == other.time} & int{body < other.body})) != 0;
    }
  };

  const Entry& First() const { return entries_[1]; }

  // Counts all times from a later origin. Times that become equal by rounding may come in any
  // order.
  void MoveOrigin(double later) {
    for (Entry& entry : entries_) entry.time -= later;
  }

  void Set(size_t body, double time) {
    size_t place = bodies_ + body;
    if (entries_[place].time == time) return;
    Entry winner = {time, static_cast<uint32_t>(body)};
    for (entries_[place] = winner; place > 1; place /= 2) {
      const Entry& opponent = entries_[place ^ 1];
      const bool is_later = opponent.IsBefore(winner);
      winner = {std::min(winner.time, opponent.time), is_later ? opponent.body : winner.body};
      entries_[place / 2] = winner;
    }
  }

 private:
  size_t bodies_;
  // From place 1, the final: the winner at place i is that of the places 2 i and 2 i + 1. Body b
  // is at place bodies + b.
  std::vector<Entry> entries_;
};

}  // namespace ballpiston
