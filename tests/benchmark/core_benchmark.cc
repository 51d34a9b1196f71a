// Costs of the core outside the lanes: a closed form, the first row of the model ladder; the start
// of a sample, to compare with the flight that follows; an event of the reference, with which the
// engines are compared.
//
//   core_benchmark
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/billiard/reference_flow.h"
#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/kernel_moments.h"
#include "core/closed_form/mean_free_time.h"
#include "core/geometry/paper.h"
#include "core/sampling/collision_surface.h"
#include "core/sampling/invariant_measure.h"
#include "core/sampling/outgoing_law.h"
#include "tests/benchmark/turns.h"

namespace ballpiston {
namespace {

PairGeometry PaperCell(double delta) { return PairGeometry::Create(kPaperRho, delta).value(); }

// A turn is 10,000 calls of `call` with another number each.
template <typename Call>
Contender CallsOf(std::string name, Call call) {
  constexpr uint64_t kCalls = 10'000;
  return {std::move(name), [call](uint64_t turn) mutable {
            for (uint64_t i = 0; i < kCalls; ++i) call(turn * kCalls + i);
            return double{kCalls};
          }};
}

std::vector<Contender> ClosedForms() {
  return {CallsOf("mean free times of a geometry",
                  [](uint64_t i) {
                    Keep(MeanFreeTimesOf(PaperCell(0.1 + 1e-9 * double(i))).ball_piston);
                  }),
          CallsOf("the kernel's three moments", [](uint64_t i) {
            const double ep = 0.1 + 1e-9 * double(i);
            Keep(PairCollisionRate(ep) + PairEnergyCurrent(ep) + PairSquaredEnergyTransfer(ep));
          })};
}

std::vector<Contender> Starts() {
  const PairGeometry geometry = PaperCell(0.05);
  std::vector<Contender> starts = {
      CallsOf("a uniform number",
              [random = CounterRandom(1, 2, 3)](uint64_t) mutable { Keep(random.Uniform()); }),
      CallsOf("start of an orbit in equilibrium", [geometry](uint64_t i) {
        CounterRandom random(1, 2, i);
        Keep(DrawFromCollisionMeasure(geometry, random).piston);
      })};
  for (const double exponent : {0, 1, 10, 1000}) {
    starts.push_back(CallsOf(absl::StrCat("start of a first hit, exponent ", exponent),
                             [geometry, law = OutgoingLaw(0.125, exponent)](uint64_t i) {
                               CounterRandom random(1, 2, i);
                               Keep(UniformOnCollisionSurface(geometry, random).x());
                               Keep(law.Draw(random).sigma);
                             }));
  }
  return starts;
}

std::vector<Contender> EventsOfTheReference() {
  std::vector<Contender> flows;
  for (const double delta : {0.325, 0.05, 0.0125}) {
    const PairGeometry geometry = PaperCell(delta);
    CounterRandom random(1, 2, 3);
    ReferenceFlow flow(geometry, DrawFromCollisionMeasure(geometry, random));
    flows.push_back(
        CallsOf(absl::StrCat("event of the reference, delta ", delta), [flow](uint64_t) mutable {
          if (flow.Step().kind == EventKind::kBallPiston) {
            flow.ExchangeComponents();
          }
        }));
  }
  return flows;
}

}  // namespace
}  // namespace ballpiston

int main() {
  using namespace ballpiston;
  for (const auto& contenders : {ClosedForms(), Starts(), EventsOfTheReference()}) {
    ShowRates(contenders, 50, "");
  }
}
