#include "server/worker/chunk_file.h"

#include <limits>
#include <string>
#include <vector>

#include "core/experiment/all_experiments.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/worker/checked_file.h"
#include "server/worker/task_file.h"
#include "tests/server/worker/sample_leases.h"
#include "tests/support/files.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

LeaseChunks ChunksOf(const IdentifiedLease& lease) {
  return {.lease = 1,
          .job = lease.job,
          .point = lease.lease.point,
          .attempt = 4,
          .chunks = AllChunks(*lease.lease.experiment),
          .processor_seconds = 0.1};
}

ChunkFile FileOf(const LeaseChunks& chunks) {
  return {.array = "an array", .task = 7, .sequence = 3, .is_final = true, .leases = {chunks}};
}

TEST(ChunkFile, ComesBackExactly) {
  const IdentifiedLease lease = LeaseOf(SpecOf(kMarkovProperty, Model::kBilliard));
  const ChunkFile file = FileOf(ChunksOf(lease));
  const TemporaryFolder folder;
  ASSERT_OK(WriteChunkFile(folder.path(), file));
  EXPECT_THAT(NamesIn(folder.path()), ElementsAre("task-7.3.chunks"));
  ASSERT_OK_AND_ASSIGN(const ChunkFile back, ReadChunkFile(folder.path(), {7, 3}));
  EXPECT_EQ(back.array, "an array");
  EXPECT_TRUE(back.is_final);
  ASSERT_EQ(back.leases.size(), 1u);
  EXPECT_EQ(back.leases[0].lease, 1u);
  EXPECT_EQ(back.leases[0].job, SomeJob());
  EXPECT_EQ(back.leases[0].point, 5u);
  EXPECT_EQ(back.leases[0].attempt, 4);
  EXPECT_EQ(back.leases[0].processor_seconds, 0.1);
  EXPECT_TRUE(AreEqual(back.leases[0].chunks, file.leases[0].chunks));
  EXPECT_OK(CheckLeaseChunks(lease, back.leases[0]));
}

TEST(ChunkFile, TheNameHasToFitTheContent) {
  const ChunkFile file = {.array = "a", .task = 7, .sequence = 3};
  const TemporaryFolder folder;
  for (const ChunkFileName& name : {ChunkFileName{6, 3}, ChunkFileName{7, 4}}) {
    WriteFile(folder.File(name.Text()), FrameOf(FileKind::kChunks, ChunkFilePayload(file)));
    EXPECT_THAT(ReadChunkFile(folder.path(), name),
                StatusIs(absl::StatusCode::kDataLoss, HasSubstr(name.Text())));
  }
}

TEST(ChunkFile, AMessageThatCannotBeReadIsDataLoss) {
  EXPECT_THAT(ChunkFileFromPayload("\xff\xff"), StatusIs(absl::StatusCode::kDataLoss));
}

TEST(ChunkFile, ImpossibleNumbersAreDataLossWithTheirField) {
  LeaseChunks chunks = {.attempt = 0};
  EXPECT_THAT(ChunkFileFromPayload(ChunkFilePayload(FileOf(chunks))),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("attempt")));
  for (const double seconds :
       {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    chunks = {.processor_seconds = seconds};
    EXPECT_THAT(ChunkFileFromPayload(ChunkFilePayload(FileOf(chunks))),
                StatusIs(absl::StatusCode::kDataLoss, HasSubstr("processor_seconds")));
  }
}

TEST(ChunkFile, NamesAreListedInOrder) {
  const TemporaryFolder folder;
  for (const char* name : {"task-10.0.chunks", "task-2.10.chunks", "task-2.9.chunks"}) {
    WriteFile(folder.File(name), "");
  }
  for (const char* name : {"task-1.0.chunks.00000000deadbeef.tmp", "task-01.0.chunks", "tasks",
                           "task-+1.0.chunks", "task-1.chunks", "task-1.-1.chunks"}) {
    WriteFile(folder.File(name), "");
  }
  ASSERT_OK_AND_ASSIGN(const auto names, ListChunkFiles(folder.path()));
  std::vector<std::string> texts;
  for (const ChunkFileName& name : names) texts.push_back(name.Text());
  EXPECT_THAT(texts, ElementsAre("task-2.9.chunks", "task-2.10.chunks", "task-10.0.chunks"));
  EXPECT_THAT(ListChunkFiles(folder.File("missing")), StatusIs(absl::StatusCode::kUnavailable));
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

TEST(TaskFile, EachTaskReadsItsLeases) {
  const IdentifiedLease a = LeaseOf(SpecOf(kFirstHit, Model::kBilliard));
  const IdentifiedLease b = LeaseOf(SpecOf(kEquilibrium, Model::kBilliardReference));
  const TemporaryFolder folder;
  const std::string path = folder.File("tasks");
  ASSERT_OK(WriteTaskFile(path, "an array", {{a}, {b, a}, {}}));
  ASSERT_OK_AND_ASSIGN(const ArrayTask task, ReadTask(path, 1));
  EXPECT_EQ(task.array, "an array");
  EXPECT_EQ(task.task, 1u);
  ASSERT_EQ(task.leases.size(), 2u);
  EXPECT_EQ(task.leases[0].lease.spec->experiment, &kEquilibrium);
  EXPECT_EQ(task.leases[1].lease.spec->experiment, &kFirstHit);
  EXPECT_THAT(ReadTask(path, 3), StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("task 3")));
}

TEST(TaskFile, AMessageThatCannotBeReadIsDataLoss) {
  const TemporaryFolder folder;
  const std::string path = folder.File("tasks");
  WriteFile(path, FrameOf(FileKind::kTasks, "\xff\xff"));
  EXPECT_THAT(ReadTask(path, 0), StatusIs(absl::StatusCode::kDataLoss, HasSubstr(path)));
}

}  // namespace
}  // namespace ballpiston::server
