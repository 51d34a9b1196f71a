// The times of the next events of many bodies, and the earliest of them: a heap that stores the
// place of each body. Bodies with equal times come in the order of their numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace ballpiston {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

class EventQueue {
 public:
  // No body has an event.
  explicit EventQueue(size_t bodies) {
    heap_.reserve(bodies);
    place_.reserve(bodies);
    for (uint32_t i = 0; i < bodies; ++i) {
      heap_.push_back({kNever, i});
      place_.push_back(i);
    }
  }

  struct Entry {
    double time;
    uint32_t body;

    bool IsBefore(const Entry& other) const {
      return time < other.time || (time == other.time && body < other.body);
    }
  };

  const Entry& First() const { return heap_[0]; }

  // Counts all times from a later origin. Times that become equal by rounding may come in any
  // order.
  void MoveOrigin(double later) {
    for (Entry& entry : heap_) entry.time -= later;
  }

  void Set(size_t body, double time) {
    const Entry entry = {time, static_cast<uint32_t>(body)};
    const size_t place = place_[body];
    if (heap_[place].time == time) return;
    if (place > 0 && entry.IsBefore(heap_[(place - 1) / kChildren])) {
      Rise(place, entry);
    } else {
      Sink(place, entry);
    }
  }

 private:
  static constexpr size_t kChildren = 4;

  void Put(size_t place, const Entry& entry) {
    heap_[place] = entry;
    place_[entry.body] = static_cast<uint32_t>(place);
  }

  void Rise(size_t place, const Entry& entry) {
    while (place > 0 && entry.IsBefore(heap_[(place - 1) / kChildren])) {
      Put(place, heap_[(place - 1) / kChildren]);
      place = (place - 1) / kChildren;
    }
    Put(place, entry);
  }

  void Sink(size_t place, const Entry& entry) {
    for (;;) {
      const size_t child = FirstChild(place);
      if (child >= heap_.size() || !heap_[child].IsBefore(entry)) break;
      Put(place, heap_[child]);
      place = child;
    }
    Put(place, entry);
  }

  // The earliest child of `place`; heap_.size() or more if there is none.
  size_t FirstChild(size_t place) const {
    size_t first = kChildren * place + 1;
    const size_t end = first + kChildren < heap_.size() ? first + kChildren : heap_.size();
    for (size_t child = first + 1; child < end; ++child) {
      if (heap_[child].IsBefore(heap_[first])) first = child;
    }
    return first;
  }

  std::vector<Entry> heap_;
  std::vector<uint32_t> place_;
};

}  // namespace ballpiston
