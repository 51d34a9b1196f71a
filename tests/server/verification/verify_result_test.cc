#include "server/verification/verify_result.h"

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "gmock/gmock.h"
#include "google/protobuf/util/json_util.h"
#include "gtest/gtest.h"
#include "server/convert/point_result.h"
#include "server/convert/spec.h"
#include "tests/support/files.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto kDiffers = absl::StatusCode::kDataLoss;
constexpr double kNeverWhole = -1;

v1::PointResult ComputedPoint(const EnsembleSpec& spec, size_t index) {
  const auto experiment = PointExperiment::Create(spec, index, {.model = spec.model});
  LocalPoint point(*experiment);
  if (experiment->plan().samples() > 0) point.Run();
  const PointSummary summary = experiment->Summarize(point.Merged());
  return WithDetails(ResultOf(index, *experiment, summary),
                     DetailsOf(summary, point.State().chunk_digests), *spec.experiment);
}

v1::SavedResult Saved(const EnsembleSpec& spec) {
  v1::SavedResult saved;
  saved.mutable_job()->set_name("ensembleJobs/abc");
  saved.mutable_job()->set_engine_version(EngineVersion());
  *saved.mutable_job()->mutable_spec() = SpecMessage(spec);
  for (size_t i = 0; i < PointCount(spec); ++i) *saved.add_points() = ComputedPoint(spec, i);
  return saved;
}

EnsembleSpec FirstHits(Model model = Model::kBilliard) {
  return {.experiment = &kFirstHit,
          .grid = {{kRho, {0.5296}}, {kDelta, {0.2, 0.1}}, {kEpsilon, {0.125}}, {kExponent, {1}}},
          .target = {.samples = 4000},
          .seed = 7,
          .model = model};
}

absl::StatusOr<std::string> Verified(const v1::SavedResult& saved,
                                     double whole_seconds = kWholePointSeconds, unsigned seed = 1) {
  std::mt19937 random(seed);
  return VerifySaved(saved, random, whole_seconds);
}

TEST(VerifyResult, EveryModelGivesTheSameNumbersAgain) {
  const EnsembleSpec relaxation = {.experiment = &kEnergyRelaxation,
                                   .grid = {{kRho, {0.5296}}, {kDelta, {0.1}}},
                                   .target = {.samples = 300},
                                   .seed = 3};
  for (const Model model :
       {Model::kSpectrum, Model::kMarkov, Model::kBilliard, Model::kBilliardReference}) {
    EnsembleSpec spec = relaxation;
    spec.model = model;
    EXPECT_THAT(Verified(Saved(spec)), IsOkAndHolds(HasSubstr("everything is equal")));
  }
  EnsembleSpec closed = FirstHits(Model::kClosedForm);
  closed.experiment = &kConditionalMeanFreeTime;
  closed.grid[kExponent].clear();
  EXPECT_THAT(Verified(Saved(closed)), IsOkAndHolds(HasSubstr("everything is equal")));
}

TEST(VerifyResult, APointWithAToleranceEndsAtTheSameChunk) {
  EnsembleSpec spec = FirstHits();
  spec.target = {.tolerance = 0.01};
  const v1::SavedResult saved = Saved(spec);
  ASSERT_GT(saved.points(0).chunk_digests_size(), 1);
  EXPECT_THAT(Verified(saved), IsOkAndHolds(HasSubstr("everything is equal")));
}

// 20 random draws reach each of the two points, but for one in 10^6 seeds; this seed does.
TEST(VerifyResult, AChunkOfALongPointHasTheSameBits) {
  const v1::SavedResult saved = Saved(FirstHits());
  bool first = false, second = false;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto verified = Verified(saved, kNeverWhole, seed);
    ASSERT_OK(verified);
    EXPECT_THAT(*verified, HasSubstr("the bits are equal"));
    first |= verified->find("point 0: chunk") != std::string::npos;
    second |= verified->find("point 1: chunk") != std::string::npos;
  }
  EXPECT_TRUE(first && second);
}

TEST(VerifyResult, AnAlteredNumberIsFound) {
  const v1::SavedResult saved = Saved(FirstHits());
  std::vector<v1::SavedResult> altered(4, saved);
  for (v1::PointResult& point : *altered[0].mutable_points()) {
    point.mutable_estimates(1)->set_value(point.estimates(1).value() * (1 + 1e-6));
  }
  for (v1::PointResult& point : *altered[1].mutable_points()) {
    point.mutable_histograms(0)->set_counts(500, point.histograms(0).counts(500) + 1);
  }
  for (v1::PointResult& point : *altered[2].mutable_points()) point.clear_curves();
  altered[3].mutable_job()->mutable_spec()->set_seed(8);
  for (const v1::SavedResult& file : altered) {
    EXPECT_THAT(Verified(file), StatusIs(kDiffers, HasSubstr("not what this engine computes")));
  }
  EXPECT_THAT(Verified(altered[0]), StatusIs(kDiffers, HasSubstr("estimates[1].value")));
}

TEST(VerifyResult, AnAlteredChunkIsFound) {
  const v1::SavedResult saved = Saved(FirstHits());
  v1::SavedResult digests = saved, seed = saved;
  for (v1::PointResult& point : *digests.mutable_points()) {
    for (uint64_t& digest : *point.mutable_chunk_digests()) digest ^= 1;
  }
  seed.mutable_job()->mutable_spec()->set_seed(8);
  for (const v1::SavedResult& file : {digests, seed}) {
    EXPECT_THAT(Verified(file, kNeverWhole), StatusIs(kDiffers, HasSubstr("the digest of chunk")));
  }
}

TEST(VerifyResult, AFileThatContradictsItselfIsFound) {
  const v1::SavedResult saved = Saved(FirstHits());
  std::vector<v1::SavedResult> wrong(4, saved);
  for (v1::PointResult& point : *wrong[0].mutable_points()) point.set_index(2);
  for (v1::PointResult& point : *wrong[1].mutable_points()) point.set_index(-1);
  for (v1::PointResult& point : *wrong[2].mutable_points()) {
    point.mutable_parameters()->set_delta(0.15);
  }
  for (v1::PointResult& point : *wrong[3].mutable_points()) {
    point.set_model(v1::EnsembleSpec::CLOSED_FORM);  // it does not answer the experiment
  }
  for (const v1::SavedResult& file : wrong) EXPECT_THAT(Verified(file), StatusIs(kDiffers));
  v1::SavedResult more = saved;
  for (v1::PointResult& point : *more.mutable_points()) {
    for (int i = 0; i < 100; ++i) point.add_chunk_digests(1);
  }
  EXPECT_THAT(Verified(more, kNeverWhole), StatusIs(kDiffers, HasSubstr("the plan has")));
}

TEST(VerifyResult, AnotherEngineIsNamed) {
  v1::SavedResult saved = Saved(FirstHits());
  saved.mutable_job()->set_engine_version("0.0.1");
  EXPECT_THAT(Verified(saved), StatusIs(absl::StatusCode::kFailedPrecondition,
                                        AllOf(HasSubstr("0.0.1"), HasSubstr(EngineVersion()))));
}

TEST(VerifyResult, AFileThatIsNoResultIsInvalid) {
  const TemporaryFolder folder;
  const std::string file = folder.path() + "/result.json";
  v1::SavedResult saved = Saved(FirstHits());
  saved.mutable_job()->mutable_spec()->mutable_grid()->set_delta(0, 0.9);
  std::string invalid;
  google::protobuf::util::MessageToJsonString(saved, &invalid);
  std::mt19937 random(1);
  EXPECT_THAT(VerifyResult(file, random), StatusIs(absl::StatusCode::kInvalidArgument));
  for (const std::string& text : {std::string(), std::string("{}"), std::string("# csv\n1,2\n"),
                                  std::string("{\"job\": {}, \"points\": []}"), invalid}) {
    WriteFile(file, text);
    EXPECT_THAT(VerifyResult(file, random), Not(IsOk())) << text.substr(0, 40);
  }
}

}  // namespace
}  // namespace ballpiston::server
