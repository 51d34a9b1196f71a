#include "core/gas/event_queue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "core/sampling/counter_random.h"

namespace ballpiston {
namespace {

// A slow implementation: all bodies in order, by time and then by number.
class OrderedEvents {
 public:
  explicit OrderedEvents(size_t bodies) : times_(bodies, kNever) {
    for (size_t i = 0; i < bodies; ++i) order_.insert({kNever, i});
  }
  void Set(size_t body, double time) {
    order_.erase({times_[body], body});
    order_.insert({times_[body] = time, body});
  }
  std::pair<double, size_t> First() const { return *order_.begin(); }

 private:
  std::vector<double> times_;
  std::set<std::pair<double, size_t>> order_;
};

void ExpectSameFirst(const EventQueue& queue, const OrderedEvents& expected) {
  ASSERT_EQ(queue.First().time, expected.First().first);
  ASSERT_EQ(queue.First().body, expected.First().second);
}

// Whole numbers as times make many ties. The first body is changed more often than others, as in a
// gas.
TEST(EventQueue, KeepsTheOrderUnderRandomChanges) {
  for (const size_t bodies : {1u, 2u, 3u, 5u, 6u, 17u, 100u}) {
    CounterRandom random(31, 0, bodies);
    EventQueue queue(bodies);
    OrderedEvents expected(bodies);
    for (int change = 0; change < 10'000; ++change) {
      const bool is_first = random.Uniform() < 0.5;
      const size_t body = is_first ? queue.First().body : random.Bits() % bodies;
      const double time =
          random.Uniform() < 0.1 ? kNever : std::floor(random.Uniform() * 2 * 17) + change / 100;
      queue.Set(body, time);
      expected.Set(body, time);
      ASSERT_NO_FATAL_FAILURE(ExpectSameFirst(queue, expected))
          << bodies << " bodies, change " << change;
    }
  }
}

TEST(EventQueue, EmptiesInTheOrderOfTime) {
  constexpr size_t kBodies = 1000;
  CounterRandom random(31, 1, 0);
  EventQueue queue(kBodies);
  OrderedEvents expected(kBodies);
  for (size_t i = 0; i < kBodies; ++i) {
    const double time = random.Uniform();
    queue.Set(i, time);
    expected.Set(i, time);
  }
  for (size_t i = 0; i <= kBodies; ++i) {
    ASSERT_NO_FATAL_FAILURE(ExpectSameFirst(queue, expected)) << i;
    const size_t body = expected.First().second;
    queue.Set(body, kNever);
    expected.Set(body, kNever);
  }
  EXPECT_EQ(queue.First().time, kNever);
}

TEST(EventQueue, BodiesWithEqualTimesComeByNumber) {
  constexpr size_t kBodies = 50;
  EventQueue queue(kBodies);
  EXPECT_EQ(queue.First().body, 0u);
  for (size_t i = kBodies; i-- > 0;) queue.Set(i, 1);
  for (size_t i = 0; i < kBodies; ++i) {
    EXPECT_EQ(queue.First().body, i);
    EXPECT_EQ(queue.First().time, 1);
    queue.Set(i, 2);
  }
  EXPECT_EQ(queue.First().body, 0u);
  EXPECT_EQ(queue.First().time, 2);
}

}  // namespace
}  // namespace ballpiston
