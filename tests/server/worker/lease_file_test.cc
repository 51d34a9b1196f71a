#include "server/worker/lease_file.h"

#include "core/experiment/all_experiments.h"
#include "server/convert/compressed.h"
#include "tests/server/worker/sample_leases.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

TEST(LeaseFile, NamesSayWhoseTheFileIs) {
  const LeaseFileName name = {"0123-7", "node1-42-abcd"};
  EXPECT_EQ(name.Todo(), "todo/0123-7");
  EXPECT_EQ(name.Taken(), "taken/0123-7.node1-42-abcd");
  EXPECT_EQ(name.Done(Outcome::kNoMemory), "done/0123-7.node1-42-abcd.no-memory");
  const auto taken = ParseTaken("0123-7.node1-42-abcd");
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->Taken(), name.Taken());
  const auto done = ParseDone("0123-7.node1-42-abcd.crashed");
  ASSERT_TRUE(done);
  EXPECT_EQ(done->worker, name.worker);
  EXPECT_EQ(done->outcome, Outcome::kCrashed);
  for (const char* other : {"", "a", ".a", "a.", "a.b.", "a.b.c", "a.b.c.finished", ".nfs0001"}) {
    EXPECT_FALSE(ParseDone(other)) << other;
  }
  for (const char* other : {"", "a", ".a", "a.", "a.b.finished"}) {
    EXPECT_FALSE(ParseTaken(other)) << other;
  }
}

TEST(LeaseFile, ALeaseAndItsChunksComeBack) {
  const Lease lease = LeaseOf(SpecOf(kMarkovProperty, Model::kBilliard));
  const LeaseReport report = {.chunks = AllChunks(*lease.experiment), .seconds = 0.1};
  const std::string file = BytesOf(RecordOf(lease, 2.5)) + BytesOf(report);
  absl::string_view rest = file;
  ASSERT_OK_AND_ASSIGN(const LeaseFile begin, TakeLease(rest));
  EXPECT_EQ(begin.lease.point, lease.point);
  EXPECT_EQ(begin.touch_seconds, 2.5);
  ASSERT_OK_AND_ASSIGN(const LeaseReport back, TakeReport(rest));
  EXPECT_EQ(back.seconds, 0.1);
  EXPECT_TRUE(AreEqual(back.chunks, report.chunks));
  EXPECT_TRUE(rest.empty());
}

template <typename Take>
void ExpectDataLoss(Take take, const std::string& bytes) {
  absl::string_view rest = bytes;
  EXPECT_THAT(take(rest), StatusIs(absl::StatusCode::kDataLoss));
}

TEST(LeaseFile, DamageIsDataLoss) {
  const Lease lease = LeaseOf(SpecOf(kFirstHit, Model::kBilliard));
  ExpectDataLoss(TakeLease, Compressed("\xff\xff"));
  ExpectDataLoss(TakeReport, Compressed("\xff\xff"));
  for (const double seconds :
       {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    ExpectDataLoss(TakeLease, BytesOf(RecordOf(lease, seconds)));
    ExpectDataLoss(TakeReport, BytesOf(LeaseReport{.seconds = seconds}));
  }
}

}  // namespace
}  // namespace ballpiston::server
