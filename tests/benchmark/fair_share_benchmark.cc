// The cost of choosing the next run, which the scheduler does under its lock for each turn of
// 0.05 s: with many runs, with many principals, and with runs that have no block to compute.
//
//   fair_share_benchmark
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/compute/fair_share.h"
#include "tests/benchmark/turns.h"

namespace ballpiston::server {
namespace {

constexpr double kBlockSeconds = 0.1;
constexpr int kChoices = 1000;  // of a turn

std::shared_ptr<FairShare> RunsOf(int64_t runs, int64_t principals) {
  auto share = std::make_shared<FairShare>();
  for (int64_t run = 0; run < runs; ++run) {
    share->Add(run, "principal " + std::to_string(run % principals), 0);
  }
  return share;
}

// So many runs, older than the others, wait for their blocks in flight.
Contender Choices(int64_t runs, int64_t principals, int64_t waiting = 0) {
  return {absl::StrCat(runs, " runs, ", principals, " principals, ", waiting, " wait"),
          [share = RunsOf(runs, principals), waiting](uint64_t) {
            for (int i = 0; i < kChoices; ++i) {
              const auto run = share->First([waiting](int64_t asked) { return asked >= waiting; });
              share->TurnBegins(*run);
              share->TurnEnds(*run, kBlockSeconds);
            }
            return double{kChoices};
          }};
}

Contender Additions(int64_t runs) {
  return {absl::StrCat("add and remove one of ", runs),
          [share = RunsOf(runs, 10), run = runs](uint64_t) mutable {
            for (int i = 0; i < kChoices; ++i) {
              share->Add(++run, "principal 3", 0);
              share->Remove(run);
            }
            return double{kChoices};
          }};
}

}  // namespace
}  // namespace ballpiston::server

int main() {
  using ballpiston::server::Choices, ballpiston::server::Additions;
  ballpiston::ShowRates({Choices(1, 1), Choices(100, 1), Choices(10'000, 1), Choices(10'000, 100),
                         Choices(10'000, 10'000), Choices(10'000, 10, 2), Choices(10'000, 10, 64),
                         Choices(10'000, 10, 1024), Additions(10'000)},
                        30, "");
}
