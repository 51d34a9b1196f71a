// The complaints find planted failures.
#include "tools/stability/results.h"

#include "tests/support/preamble.h"

namespace ballpiston::stability {
namespace {

// One naive method and one that promises zeros, in one case.
Results ResultsWith(const Failures& naive, const Failures& promised) {
  Results results;
  results.systems = {
      {"The gas", {{"grazing", {{"fixed steps", false, naive}, {"lanes", true, promised}}}}, {}}};
  return results;
}

TEST(Results, AFailureOfAnEngineThatPromisesZerosIsABrokenPromise) {
  const Failures missed = {.missed = 1};
  EXPECT_THAT(BrokenPromises(ResultsWith(missed, {})), IsEmpty());
  EXPECT_THAT(BrokenPromises(ResultsWith({}, missed)), ElementsAre("lanes fails: grazing"));
}

TEST(Results, ALossOfEnergyIsABrokenPromise) {
  Results results;
  results.energy = {{.method = "lanes",
                     .what = "pairs",
                     .orbits = 1,
                     .hits = 1,
                     .promised = true,
                     .worst = 2e-14,
                     .permitted = 1e-14,
                     .change = {}}};
  EXPECT_THAT(BrokenPromises(results), ElementsAre("lanes loses energy: pairs"));
  results.energy.front().promised = false;
  EXPECT_THAT(BrokenPromises(results), IsEmpty());
}

TEST(Results, AKindOfFailureThatNoMethodShowsIsABlindLook) {
  Failures all;
  for (const FailureKind& kind : kFailureKinds) all.*kind.count = 1;
  all.phantoms = 0;
  EXPECT_THAT(BlindLooks(ResultsWith(all, {})), IsEmpty());
  all.inward = 0;
  EXPECT_THAT(BlindLooks(ResultsWith(all, {})),
              ElementsAre("no method showed this failure: still inward"));
}

}  // namespace
}  // namespace ballpiston::stability
