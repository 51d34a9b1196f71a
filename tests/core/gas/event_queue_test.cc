#include "core/gas/event_queue.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// Whole numbers as times make many ties. At the end the queue is emptied.
TEST(EventQueue, FirstBodyIsThatOfAnOrderedSet) {
  for (const size_t bodies : {1u, 2u, 3u, 6u, 17u, 100u}) {
    CounterRandom random(31, 0, bodies);
    EventQueue queue(bodies);
    std::vector<double> times(bodies, kNever);
    std::set<std::pair<double, size_t>> order;
    for (size_t body = 0; body < bodies; ++body) order.insert({kNever, body});
    for (int change = 0; change < 2000 || queue.First().time != kNever; ++change) {
      const bool is_first = change >= 2000 || random.Uniform() < 0.5;
      const size_t body = is_first ? queue.First().body : random.Bits() % bodies;
      const bool has_event = change < 2000 && random.Uniform() < 0.9;
      const double time = has_event ? std::floor(34 * random.Uniform()) + change / 100 : kNever;
      queue.Set(body, time);
      order.erase({times[body], body});
      order.insert({times[body] = time, body});
      ASSERT_EQ(std::pair(queue.First().time, size_t{queue.First().body}), *order.begin())
          << bodies << " bodies, change " << change;
    }
  }
}

}  // namespace
}  // namespace ballpiston
