#include "server/cluster/slurm_queue.h"

#include <limits>
#include <map>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Key;
using ::testing::UnorderedElementsAre;

constexpr size_t kMost = 1000;

QueuedArray OnlyArray(const std::string& lines) {
  const std::map<std::string, QueuedArray> arrays = ParseQueue(lines, "bp-");
  EXPECT_EQ(arrays.size(), 1u) << lines;
  return arrays.empty() ? QueuedArray() : arrays.begin()->second;
}

TEST(SlurmIndices, AreNumbersRangesAndRangesWithAStep) {
  EXPECT_THAT(ParseIndices("7", kMost), ElementsAre(7));
  EXPECT_THAT(ParseIndices("0-3", kMost), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(ParseIndices("1-9:4", kMost), ElementsAre(1, 5, 9));
  EXPECT_THAT(ParseIndices("1-8:4", kMost), ElementsAre(1, 5));
  EXPECT_THAT(ParseIndices("0-1,5,8-9", kMost), ElementsAre(0, 1, 5, 8, 9));
}

TEST(SlurmIndices, TheLimitOfTasksAtATimeIsLeftOut) {
  EXPECT_THAT(ParseIndices("0-1%1", kMost), ElementsAre(0, 1));
  EXPECT_THAT(ParseIndices("3,5%20", kMost), ElementsAre(3, 5));
}

// squeue cuts a list to 64 characters unless SLURM_BITSTR_LEN is 0.
TEST(SlurmIndices, TheDotsOfACutListAreLeftOut) {
  EXPECT_THAT(ParseIndices("1-2,5,8-9,...", kMost), ElementsAre(1, 2, 5, 8, 9));
  EXPECT_THAT(ParseIndices("1-2,48,57...", kMost), ElementsAre(1, 2, 48));
}

TEST(SlurmIndices, GarbageHasNoIndices) {
  for (const std::string text : {"", "N/A", "-", "-3", "3-", "a-b", "1-2-3", "0-9:0", "0-9:x", ",",
                                 "0x10", "1e3", "99999999999999999999"}) {
    EXPECT_THAT(ParseIndices(text, kMost), IsEmpty()) << text;
  }
  EXPECT_THAT(ParseIndices("5-3", kMost), IsEmpty());
}

TEST(SlurmIndices, AHugeRangeEndsAtTheGreatestIndex) {
  EXPECT_EQ(ParseIndices("0-18446744073709551615", kMost).size(), kMost + 1);
  EXPECT_THAT(ParseIndices("999-4000000000", kMost), ElementsAre(999, 1000));
  EXPECT_THAT(ParseIndices("1-1000:18446744073709551615", kMost), ElementsAre(1));
}

TEST(SlurmIndices, TheTextIsTheShortest) {
  EXPECT_EQ(IndicesText({}), "");
  EXPECT_EQ(IndicesText({7}), "7");
  EXPECT_EQ(IndicesText({0, 1, 2, 5, 7, 8}), "0-2,5,7-8");
  const std::set<size_t> indices = {0, 3, 4, 5, 9, 11, 12};
  EXPECT_EQ(ParseIndices(IndicesText(indices), kMost), indices);
}

TEST(SlurmQueue, AnArrayHasWaitingAndRunningTasks) {
  const QueuedArray array = OnlyArray(
      "12|911-1000|bp-a|PENDING|Resources\n"
      "12|903|bp-a|RUNNING|None\n"
      "12|904|bp-a|COMPLETING|None\n");
  EXPECT_EQ(array.id, "12");
  EXPECT_EQ(array.waiting.size(), 90u);
  EXPECT_THAT(array.running, ElementsAre(903, 904));
  EXPECT_THAT(array.reasons, ElementsAre("Resources"));
}

TEST(SlurmQueue, EveryStateOfATaskThatHasNotEndedCounts) {
  for (const std::string state :
       {"PENDING", "REQUEUED", "REQUEUE_HOLD", "REQUEUE_FED", "SPECIAL_EXIT", "RESV_DEL_HOLD"}) {
    EXPECT_THAT(OnlyArray(absl::StrCat("1|4|bp-a|", state, "|None\n")).waiting, ElementsAre(4));
  }
  for (const std::string state : {"RUNNING", "COMPLETING", "CONFIGURING", "SUSPENDED", "STOPPED",
                                  "SIGNALING", "RESIZING", "STAGE_OUT"}) {
    EXPECT_THAT(OnlyArray(absl::StrCat("1|4|bp-a|", state, "|None\n")).running, ElementsAre(4));
  }
}

TEST(SlurmQueue, TasksThatHaveEndedAreLeftOut) {
  for (const std::string state : {"COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "PREEMPTED",
                                  "NODE_FAIL", "OUT_OF_MEMORY", "BOOT_FAIL", "DEADLINE"}) {
    EXPECT_THAT(ParseQueue(absl::StrCat("1|4|bp-a|", state, "|None\n"), "bp-"), IsEmpty()) << state;
  }
}

TEST(SlurmQueue, ArraysAreKeptApartByName) {
  const auto arrays = ParseQueue(
      "1|0-2|bp-a|PENDING|Priority\n"
      "2|1|bp-b|RUNNING|None\n",
      "bp-");
  EXPECT_THAT(arrays, UnorderedElementsAre(Key("bp-a"), Key("bp-b")));
  EXPECT_THAT(arrays.at("bp-b").waiting, IsEmpty());
}

TEST(SlurmQueue, ForeignNamesAreLeftOut) {
  EXPECT_THAT(ParseQueue("3|N/A|other|PENDING|Priority\n"
                         "4|0|bp|RUNNING|None\n"
                         "5|0|xbp-a|RUNNING|None\n"
                         "6|0|BP-a|RUNNING|None\n",
                         "bp-"),
              IsEmpty());
}

// A reason may hold commas and blanks, and is the last field.
TEST(SlurmQueue, AReasonMayHoldAnyCharacter) {
  const std::string reason =
      "Nodes required for job are DOWN, DRAINED or reserved for jobs in higher priority partitions";
  EXPECT_THAT(OnlyArray(absl::StrCat("1|0|bp-a|PENDING|", reason, "\n")).reasons,
              ElementsAre(reason));
  EXPECT_THAT(OnlyArray("1|0|bp-a|PENDING|a|b\n").reasons, ElementsAre("a|b"));
}

// Another program's job may have such a name. Its line has one field more.
TEST(SlurmQueue, ANameWithABarIsIgnored) {
  EXPECT_THAT(ParseQueue("1|0|bp-a|x|RUNNING|None\n", "bp-"), IsEmpty());
}

TEST(SlurmQueue, AnArrayWithoutIndicesHasNoTasks) {
  const QueuedArray array = OnlyArray("1|N/A|bp-a|PENDING|None\n");
  EXPECT_THAT(array.waiting, IsEmpty());
}

TEST(SlurmQueue, GarbageIsLeftOut) {
  for (const std::string lines :
       {"", "\n\n", "|||||", "||||", "1|2|bp-a|RUNNING", "bp-a", "squeue: error: something"}) {
    EXPECT_THAT(ParseQueue(lines, "bp-"), IsEmpty()) << lines;
  }
  EXPECT_THAT(OnlyArray("garbage\n1|2|bp-a|RUNNING|None\n\xff\xfe\n").running, ElementsAre(2));
}

TEST(SlurmQueue, SomeReasonsLastForEver) {
  for (const std::string reason : {"PartitionTimeLimit", "PartitionConfig", "PartitionNodeLimit",
                                   "PartitionDown", "JobHeldUser", "JobHeldAdmin"}) {
    EXPECT_TRUE(WaitsForever(reason)) << reason;
  }
  for (const std::string reason :
       {"", "None", "Resources", "Priority", "BeginTime", "QOSMaxJobsPerUserLimit", "NodeDown",
        "ReqNodeNotAvail, UnavailableNodes:n[1-2]"}) {
    EXPECT_FALSE(WaitsForever(reason)) << reason;
  }
}

}  // namespace
}  // namespace ballpiston::server
