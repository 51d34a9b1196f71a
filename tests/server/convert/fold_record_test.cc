#include "server/convert/fold_record.h"

#include "tests/core/one_point_spec.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

constexpr uint64_t kLargest = std::numeric_limits<uint64_t>::max();

auto IsDataLoss() { return StatusIs(absl::StatusCode::kDataLoss); }

TEST(FoldRecord, ComesBackExactly) {
  BlockResult block;
  block.samples = 12345678901234;
  block.moments = {{3, 0.1, 1e-300, -2.5, 5e-324}, {}};
  block.batch_means = {{{7, 0.3, 2, -1, 5}, -0.0, 1e300, 3}};
  block.histograms = {{-1.5, 1.5, {0, 1, kLargest}}};
  block.health = {2, 1e-15};
  const FoldState state = {.chunk = 2, .blocks = 3, .complete = block, .partial = {}};
  ASSERT_OK_AND_ASSIGN(const auto stored,
                       CheckpointFromBytes(FoldRecordBytes(state, Model::kMarkov)));
  EXPECT_EQ(stored.model, Model::kMarkov);
  const FoldState& back = stored.state;
  EXPECT_EQ(back.chunk, 2u);
  EXPECT_EQ(back.blocks, 3u);
  EXPECT_TRUE(back.complete == block);
  EXPECT_TRUE(back.partial == BlockResult());
  EXPECT_TRUE(std::signbit(back.complete.batch_means[0].mean_denominator));
  EXPECT_THAT(FoldStateFromBytes("\xff\xff\xff"), IsDataLoss());
}

class StoredFold : public testing::Test {
 protected:
  absl::Status Checked(const FoldState& state) const { return CheckFoldState(*experiment_, state); }

  const std::unique_ptr<const PointExperiment> experiment_ = PointExperiment::Create(
      SpecOf(&kMarkovProperty, PaperPoint(0.1), {.collisions = 1'000'000}), 0);
  const ChunkPlan& plan_ = experiment_->plan();
  const BlockResult empty_ = experiment_->EmptyResult();
};

TEST_F(StoredFold, IsAcceptedWithinItsPlanOnly) {
  const uint64_t all = plan_.chunks();
  const FoldState good[] = {{.blocks = 1, .partial = empty_},
                            {.chunk = 1, .complete = empty_},
                            {.chunk = 1, .blocks = 1, .complete = empty_, .partial = empty_},
                            {.chunk = all, .complete = empty_}};
  for (const FoldState& state : good) EXPECT_OK(Checked(state));
  BlockResult too_many = empty_, no_error = empty_;
  too_many.samples = plan_.BlockAt(0, 0).samples + 1;
  no_error.health.max_energy_error = std::numeric_limits<double>::quiet_NaN();
  FoldState beyond_the_end = good[3];
  beyond_the_end.blocks = 1;
  beyond_the_end.partial = empty_;
  const FoldState bad[] = {{},                    // nothing merged yet
                           {.blocks = 1},         // the block is missing
                           {.complete = empty_},  // something before the first chunk
                           {.partial = empty_},   // or before the first block
                           {.blocks = 1, .partial = too_many},
                           {.blocks = 1, .partial = no_error},
                           {.blocks = plan_.BlocksIn(0), .partial = empty_},
                           {.chunk = all + 1, .complete = empty_},
                           beyond_the_end};
  for (const FoldState& state : bad) EXPECT_THAT(Checked(state), IsDataLoss());
}

TEST_F(StoredFold, ThatCountsASampleTwiceIsDataLoss) {
  BlockResult block = empty_;
  block.samples = 3;
  block.histograms[0].counts[0] = 1;
  block.histograms[0].counts[1] = 2;
  block.histograms[1].counts[0] = 3;
  EXPECT_OK(Checked({.blocks = 1, .partial = block}));
  for (const uint64_t beyond : {uint64_t{1}, kLargest}) {  // the second sum is 2
    block.histograms[1].counts[1] = beyond;
    EXPECT_THAT(Checked({.blocks = 1, .partial = block}), IsDataLoss());
  }
}

}  // namespace
}  // namespace ballpiston::server
