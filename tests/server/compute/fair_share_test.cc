#include "server/compute/fair_share.h"

#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

using SecondsByRun = std::map<int64_t, double>;

int64_t FirstRun(const FairShare& share) {
  return share.First([](int64_t) { return true; }).value_or(-1);
}

// Runs one worker, whose blocks take 0.1 s unless `block_seconds` has another time. Returns the
// seconds that each run got.
SecondsByRun Served(FairShare& share, double seconds, const SecondsByRun& block_seconds = {},
                    const std::set<int64_t>& without_task = {}) {
  SecondsByRun served;
  for (double now = 0; now < seconds;) {
    const auto run = share.First([&](int64_t asked) { return !without_task.contains(asked); });
    if (!run) break;
    const auto given = block_seconds.find(*run);
    const double block = given == block_seconds.end() ? 0.1 : given->second;
    share.TurnBegins(*run);
    share.TurnEnds(*run, block);
    served[*run] += block;
    now += block;
  }
  return served;
}

void AddRuns(FairShare& share, const std::vector<int64_t>& runs, const std::string& principal = "a",
             int32_t priority = 0) {
  for (const int64_t run : runs) share.Add(run, principal, priority);
}

TEST(FairShare, PrincipalsGetEqualTimeWhateverTheirJobs) {
  FairShare share;
  AddRuns(share, {1, 2, 3, 4, 5, 6, 7, 8, 9}, "many");
  AddRuns(share, {10}, "one");
  AddRuns(share, {11, 12}, "long blocks");
  const SecondsByRun served = Served(share, 300, {{11, 2.0}, {12, 2.0}});
  EXPECT_NEAR(served.at(10), 100, 2.5);
  EXPECT_NEAR(served.at(11) + served.at(12), 100, 2.5);
  EXPECT_NEAR(served.at(11), 50, 2.5);
  for (int64_t run = 1; run <= 9; ++run) EXPECT_NEAR(served.at(run), 100.0 / 9, 0.5);
}

TEST(FairShare, AHigherPriorityGoesFirstWithinItsPrincipal) {
  FairShare share;
  AddRuns(share, {1}, "a", -5);
  AddRuns(share, {2}, "a", 0);
  Served(share, 10);
  AddRuns(share, {3, 4}, "a", 100);
  const SecondsByRun served = Served(share, 100);
  EXPECT_NEAR(served.at(3), 50, 0.2);
  EXPECT_NEAR(served.at(4), 50, 0.2);
  EXPECT_EQ(served.size(), 2u);
  share.Remove(3);
  share.Remove(4);
  EXPECT_EQ(FirstRun(share), 2);
  share.Remove(2);
  EXPECT_EQ(FirstRun(share), 1);
}

// The run keeps no time from its earlier priority: it neither catches up nor waits.
TEST(FairShare, AChangedPriorityCountsFromTheNextTurn) {
  FairShare share;
  AddRuns(share, {1}, "a", 0);
  AddRuns(share, {2}, "a", -1);
  AddRuns(share, {3}, "a", 5);
  Served(share, 100);
  share.SetPriority(1, 5);
  share.SetPriority(2, 5);
  const SecondsByRun served = Served(share, 90);
  for (const int64_t run : {1, 2, 3}) EXPECT_NEAR(served.at(run), 30, 0.2);
  share.SetPriority(3, 6);
  EXPECT_NEAR(Served(share, 90).at(3), 90, 0.2);
  share.SetPriority(4, 1);  // is not present
}

TEST(FairShare, APriorityDoesNotTakeFromOtherPrincipals) {
  FairShare share;
  AddRuns(share, {1, 2}, "urgent", 100);
  AddRuns(share, {3}, "patient", -100);
  const SecondsByRun served = Served(share, 100);
  EXPECT_NEAR(served.at(1) + served.at(2), 50, 0.2);
  EXPECT_NEAR(served.at(3), 50, 0.2);
}

TEST(FairShare, ANewRunStartsAtTheLeastCharge) {
  for (const bool of_one_principal : {false, true}) {
    FairShare share;
    AddRuns(share, {1}, "a");
    Served(share, 1000);
    AddRuns(share, {2}, of_one_principal ? "a" : "b");
    const SecondsByRun served = Served(share, 100);
    EXPECT_NEAR(served.at(1), 50, 0.2);
    EXPECT_NEAR(served.at(2), 50, 0.2);
  }
}

// A run that opens a point for a long time leaves the other workers to other runs. When it goes on,
// the others do not wait until it has caught up.
TEST(FairShare, UnusedTimeGivesNoCredit) {
  for (const bool of_one_principal : {false, true}) {
    FairShare share;
    AddRuns(share, {1}, "a");
    AddRuns(share, {2}, of_one_principal ? "a" : "b");
    EXPECT_NEAR(Served(share, 1000, {}, {1}).at(2), 1000, 0.2);
    const SecondsByRun served = Served(share, 100);
    EXPECT_NEAR(served.at(1), 50, 0.2);
    EXPECT_NEAR(served.at(2), 50, 0.2);
  }
}

// A sequence of new jobs with one long block each.
TEST(FairShare, AReturningPrincipalKeepsItsLead) {
  FairShare share;
  AddRuns(share, {1}, "steady");
  SecondsByRun served;
  for (int64_t run = 2; run < 50; ++run) {
    AddRuns(share, {run}, "again");
    while (true) {
      const int64_t chosen = FirstRun(share);
      const double block = chosen == 1 ? 0.1 : 10;
      share.TurnBegins(chosen);
      share.TurnEnds(chosen, block);
      served[chosen == 1 ? 1 : 2] += block;
      if (chosen == run) break;
    }
    share.Remove(run);
  }
  EXPECT_NEAR(served.at(1) / served.at(2), 1, 0.1);
}

TEST(FairShare, BlocksInFlightAreCharged) {
  for (const bool of_one_principal : {false, true}) {
    FairShare share;
    AddRuns(share, {1}, "a");
    AddRuns(share, {2}, of_one_principal ? "a" : "b");
    share.TurnBegins(1);
    EXPECT_EQ(FirstRun(share), 2);
    share.TurnBegins(2);
    share.TurnBegins(2);
    EXPECT_EQ(FirstRun(share), 1);
  }
}

TEST(FairShare, ARemovedRunIsForgotten) {
  FairShare share;
  AddRuns(share, {1});
  share.TurnBegins(1);
  share.Remove(1);
  share.TurnEnds(1, 1.0);
  EXPECT_EQ(FirstRun(share), -1);
  AddRuns(share, {2, 3}, "a");
  AddRuns(share, {4}, "b");
  share.TurnBegins(2);
  EXPECT_EQ(FirstRun(share), 4);
  share.Remove(2);  // its block counts no more against its principal
  EXPECT_EQ(FirstRun(share), 3);
}

}  // namespace
}  // namespace ballpiston::server
