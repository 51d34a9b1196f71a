// The complaints find planted failures.
#include "tools/stability/results.h"

#include "tests/support/preamble.h"
#include "tests/support/process.h"

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
  constexpr double kPermitted = 1e-14;
  const auto complaints = [](const Failures& naive, const Failures& promised, double permitted) {
    Results results = ResultsWith(naive, promised);
    results.systems.front().cases.front().permitted = permitted;
    return BrokenPromises(results);
  };
  const Failures far_off = {.energy = 2e-14}, unknown = {.energy = 0, .gain = {.mean = NAN}},
                 drifts = {.energy = 0, .gain = {.count = 48, .mean = -1e-15}},
                 walks = {.energy = 0, .gain = {.count = 48, .mean = -1e-15, .m2 = 1e-27}},
                 is_rounded = {.energy = kPermitted, .gain = {.count = 48, .mean = 2e-16}};
  for (const Failures& lossy : {far_off, unknown, drifts}) {
    EXPECT_THAT(complaints({}, lossy, kPermitted), ElementsAre("lanes loses energy: grazing"));
    EXPECT_THAT(complaints({}, lossy, 0), IsEmpty()) << "a case of short runs";
    EXPECT_THAT(complaints(lossy, walks, kPermitted), IsEmpty());
    EXPECT_THAT(complaints(lossy, is_rounded, kPermitted), IsEmpty());
  }
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

// ---- the program ----

ProcessResult RunStability(const std::string& arguments) {
  return RunProgram({.command = {"sh", "-c", BuildPath("bin/stability") + " " + arguments}});
}

TEST(Program, HelpExitsWithZeroAndAWrongArgumentWithTwo) {
  const ProcessResult help = RunStability("--help");
  EXPECT_THAT(help, ExitsWith(0));
  EXPECT_THAT(help.out, HasSubstr("--quick"));
  for (const char* argument : {"--fast", "stability.md", ""}) {
    const ProcessResult result = RunStability(absl::StrCat("--quick '", argument, "'"));
    EXPECT_THAT(result, ExitsWith(2));
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr(absl::StrCat("'", argument, "'")));
  }
}

TEST(Program, OutputThatCannotBeWrittenExitsWithOne) {
  const ProcessResult result = RunStability("--help >/dev/full");
  EXPECT_THAT(result, ExitsWith(1));
  EXPECT_THAT(result.err, HasSubstr("cannot write to standard output"));
}

}  // namespace
}  // namespace ballpiston::stability
