// The complaints find planted failures.
#include "tools/stability/results.h"

#include "tests/support/preamble.h"
#include "tests/support/process.h"

namespace ballpiston::stability {
namespace {

// Each kind of failure that some method has to show.
Failures AllKinds() {
  Failures all;
  for (const FailureKind& kind : kFailureKinds) all.*kind.count = 1;
  all.phantoms = 0;
  return all;
}

// About one naive method and one that promises zeros, in one case.
std::vector<std::string> ComplaintsAbout(const Failures& naive, const Failures& promised,
                                         double permitted = 0) {
  return Complaints({.systems = {{"The gas",
                                  {{"grazing", permitted, "fixed steps", false, naive},
                                   {"grazing", permitted, "lanes", true, promised}},
                                  {}}},
                     .model_errors = {}});
}

TEST(Results, AFailureOfAnEngineThatPromisesZerosIsABrokenPromise) {
  EXPECT_THAT(ComplaintsAbout(AllKinds(), {}), IsEmpty());
  EXPECT_THAT(ComplaintsAbout(AllKinds(), {.missed = 1}), ElementsAre("lanes fails: grazing"));
}

TEST(Results, ALossOfEnergyIsABrokenPromise) {
  constexpr double kPermitted = 1e-14;
  const Failures far_off = {.energy = 2e-14}, unknown = {.energy = 0, .gain = {.mean = NAN}},
                 drifts = {.energy = 0, .gain = {.count = 48, .mean = -1e-15}},
                 walks = {.energy = 0, .gain = {.count = 48, .mean = -1e-15, .m2 = 1e-27}},
                 is_rounded = {.energy = kPermitted, .gain = {.count = 48, .mean = 2e-16}};
  for (const Failures& lossy : {far_off, unknown, drifts}) {
    Failures naive = AllKinds();
    naive.energy = lossy.energy;
    naive.gain = lossy.gain;
    EXPECT_THAT(ComplaintsAbout(naive, lossy, kPermitted),
                ElementsAre("lanes loses energy: grazing"));
    EXPECT_THAT(ComplaintsAbout(naive, lossy, 0), IsEmpty()) << "a case of short runs";
    EXPECT_THAT(ComplaintsAbout(naive, walks, kPermitted), IsEmpty());
    EXPECT_THAT(ComplaintsAbout(naive, is_rounded, kPermitted), IsEmpty());
  }
}

TEST(Results, AKindOfFailureThatNoMethodShowsIsABlindLook) {
  Failures all = AllKinds();
  all.inward = 0;
  EXPECT_THAT(ComplaintsAbout(all, {}), ElementsAre("no method showed this failure: still inward"));
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
