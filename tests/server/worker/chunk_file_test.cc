#include "server/worker/chunk_file.h"

#include <limits>
#include <string>

#include "core/experiment/all_experiments.h"
#include "gmock/gmock.h"
#include "server/worker/checked_file.h"
#include "server/worker/lease_file.h"
#include "tests/server/worker/sample_leases.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;

LeaseChunks ChunksOf(const IdentifiedLease& lease) {
  return {.job = lease.job,
          .point = lease.lease.point,
          .attempt = 4,
          .chunks = AllChunks(*lease.lease.experiment),
          .processor_seconds = 0.1};
}

TEST(ChunkFile, ComesBackExactly) {
  const IdentifiedLease lease = LeaseOf(SpecOf(kMarkovProperty, Model::kBilliard));
  const LeaseChunks chunks = ChunksOf(lease);
  ASSERT_OK_AND_ASSIGN(const LeaseChunks back, LeaseChunksFromPayload(LeaseChunksPayload(chunks)));
  EXPECT_EQ(back.job, SomeJob());
  EXPECT_EQ(back.point, 5u);
  EXPECT_EQ(back.attempt, 4);
  EXPECT_EQ(back.processor_seconds, 0.1);
  EXPECT_TRUE(AreEqual(back.chunks, chunks.chunks));
  EXPECT_OK(CheckLeaseChunks(lease, back));
}

TEST(ChunkFile, DamageIsDataLossWithItsField) {
  EXPECT_THAT(LeaseChunksFromPayload("\xff\xff"), StatusIs(absl::StatusCode::kDataLoss));
  const std::string unread = FrameOf(FrameKind::kLease, "\xff\xff");
  absl::string_view rest = unread;
  EXPECT_THAT(TakeLease(rest), StatusIs(absl::StatusCode::kDataLoss));
  const IdentifiedLease lease = LeaseOf(SpecOf(kFirstHit, Model::kBilliard));
  const std::string never = BytesOf(LeaseRecord(lease.lease, lease.job), -1);
  rest = never;
  EXPECT_THAT(TakeLease(rest), StatusIs(absl::StatusCode::kDataLoss));
  LeaseChunks chunks = {.attempt = 0};
  EXPECT_THAT(LeaseChunksFromPayload(LeaseChunksPayload(chunks)),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("attempt")));
  for (const double seconds :
       {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    chunks = {.processor_seconds = seconds};
    EXPECT_THAT(LeaseChunksFromPayload(LeaseChunksPayload(chunks)),
                StatusIs(absl::StatusCode::kDataLoss, HasSubstr("processor_seconds")));
  }
}

TEST(LeaseChunks, OfAnotherLeaseAreDataLoss) {
  const EnsembleSpec spec = SpecOf(kFirstHit, Model::kBilliard, 100'000);
  const IdentifiedLease lease = LeaseOf(spec);
  const LeaseChunks good = ChunksOf(lease);
  ASSERT_GT(good.chunks.size(), 1u);
  EXPECT_OK(CheckLeaseChunks(lease, good));
  LeaseChunks other_job = good, other_point = good, impossible = good;
  ++other_job.job.generation;
  ++other_point.point;
  impossible.chunks[0].result.samples = ~uint64_t{0};
  for (const LeaseChunks& chunks : {other_job, other_point, impossible}) {
    EXPECT_THAT(CheckLeaseChunks(lease, chunks), StatusIs(absl::StatusCode::kDataLoss));
  }
  EXPECT_THAT(CheckLeaseChunks(LeaseOf(spec, 0, 1), good),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("not in the lease")));
}

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
  const IdentifiedLease lease = LeaseOf(SpecOf(kFirstHit, Model::kBilliard));
  const std::string file =
      BytesOf(LeaseRecord(lease.lease, lease.job), 2.5) + BytesOf(ChunksOf(lease));
  absl::string_view rest = file;
  ASSERT_OK_AND_ASSIGN(const LeaseFile begin, TakeLease(rest));
  EXPECT_EQ(begin.lease.job, lease.job);
  EXPECT_EQ(begin.touch_seconds, 2.5);
  ASSERT_OK_AND_ASSIGN(const LeaseChunks chunks, TakeChunks(rest));
  EXPECT_OK(CheckLeaseChunks(begin.lease, chunks));
  EXPECT_TRUE(rest.empty());
}

}  // namespace
}  // namespace ballpiston::server
