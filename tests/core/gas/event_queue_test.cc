#include "core/gas/event_queue.h"

#include "tests/core/preamble.h"

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

// Whole numbers as times make many ties, which the body's number decides. The first body is changed
// more often than others, as in a gas. At the end the queue is emptied.
TEST(EventQueue, FirstBodyIsThatOfAnOrderedSet) {
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
    while (queue.First().time != kNever) {
      const size_t body = queue.First().body;
      queue.Set(body, kNever);
      expected.Set(body, kNever);
      ASSERT_NO_FATAL_FAILURE(ExpectSameFirst(queue, expected)) << bodies;
    }
  }
}

}  // namespace
}  // namespace ballpiston
