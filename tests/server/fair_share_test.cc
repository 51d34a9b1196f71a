#include "server/execution/fair_share.h"

#include <map>

#include "gtest/gtest.h"

namespace ballpiston::server {
namespace {

// One worker; each run's blocks take their time. Compute time a run got within `seconds`.
std::map<int64_t, double> Served(FairShare& share, const std::map<int64_t, double>& block_seconds,
                                 double seconds) {
  std::map<int64_t, double> served;
  for (double now = 0; now < seconds;) {
    const int64_t run = share.order().begin()->second;
    share.BlockBegins(run);
    share.BlockEnds(run, block_seconds.at(run));
    served[run] += block_seconds.at(run);
    now += block_seconds.at(run);
  }
  return served;
}

TEST(FairShare, UnequalBlocksGetEqualTime) {
  FairShare share;
  share.Add(1);
  share.Add(2);
  const auto served = Served(share, {{1, 1.0}, {2, 0.01}}, 200);
  EXPECT_NEAR(served.at(1), 100, 2);
  EXPECT_NEAR(served.at(2), 100, 2);
}

TEST(FairShare, ANewRunStartsAtTheLeastOfThosePresent) {
  FairShare share;
  share.Add(1);
  Served(share, {{1, 1.0}}, 1000);
  share.Add(2);
  const auto served = Served(share, {{1, 1.0}, {2, 1.0}}, 100);
  EXPECT_NEAR(served.at(1), 50, 1);
  EXPECT_NEAR(served.at(2), 50, 1);
}

TEST(FairShare, TheOlderRunComesFirstAtEquality) {
  FairShare share;
  share.Add(8);
  share.Add(7);
  EXPECT_EQ(share.order().begin()->second, 7);
}

TEST(FairShare, BlocksInFlightAreCharged) {
  FairShare share;
  share.Add(1);
  share.Add(2);
  share.BlockBegins(1);
  EXPECT_EQ(share.order().begin()->second, 2);
  share.BlockBegins(2);
  share.BlockBegins(2);
  EXPECT_EQ(share.order().begin()->second, 1);
}

TEST(FairShare, ARemovedRunIsForgotten) {
  FairShare share;
  share.Add(1);
  share.BlockBegins(1);
  share.Remove(1);
  share.BlockEnds(1, 1.0);
  EXPECT_TRUE(share.order().empty());
}

}  // namespace
}  // namespace ballpiston::server
