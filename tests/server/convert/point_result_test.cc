#include "server/convert/point_result.h"

#include "server/convert/deterministic_bytes.h"
#include "tests/core/one_point_spec.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

v1::PointResult PointResultOf(size_t index, const PointExperiment& experiment,
                              const BlockResult& merged,
                              const ExperimentKind& kind = kEquilibrium) {
  const PointSummary summary = experiment.Summarize(merged);
  return WithDetails(ResultOf(index, experiment, summary), DetailsOf(summary), kind);
}

class Answered : public PointExperiment {
 public:
  Answered(const EnsembleSpec& spec, PointSummary answer)
      : PointExperiment(spec, PointAt(spec, 0)), answer_(std::move(answer)) {}

 protected:
  void AddDetails(const BlockResult&, PointSummary& summary) const override { summary = answer_; }

 private:
  PointSummary answer_;
};

// An answer with everything that a result can hold. Numbers that do not exist are left out.
TEST(PointResult, EverythingThatExistsIsKept) {
  PointSummary summary;
  summary.estimates = {
      {.name = "time", .value = -4, .standard_error = 0.5, .batches = 64, .limit = 3},
      {.name = "distance", .value = 0.25, .noise_floor = 0.125},
      {.name = "odd", .value = 1, .exact = 0.5, .limit = kNan, .noise_floor = kInfinity},
      {.name = "nothing", .value = kNan}};
  summary.samples = 7;
  summary.health.max_energy_error = kNan;
  summary.curves = {{"decay", {{0, 1, 0.25, 64, 1}, {2, 0.5}, {4, 0.25, kNan, 64, kInfinity}}},
                    {"profile", {{0, 2}, {1.5, 1}}, CurveAxis::kPosition}};
  summary.remarks = {"the run was too short", "another sentence"};
  const EnsembleSpec spec = FakeSpec(1, 1);
  v1::PointResult result = PointResultOf(3, Answered(spec, summary), BlockResult());
  result.clear_parameters();
  EXPECT_EQ(result.ShortDebugString(),
            R"(index: 3 model: BILLIARD samples: 7 )"
            R"(estimates { name: "time" value: -4 standard_error: 0.5 model_error: 0 limit: 3 )"
            R"(batches: 64 } )"
            R"(estimates { name: "distance" value: 0.25 model_error: 0 noise_floor: 0.125 } )"
            R"(estimates { name: "odd" value: 1 exact: 0.5 model_error: 0 } health { } )"
            R"(remarks: "the run was too short" remarks: "another sentence" )"
            R"(remarks: "nothing has no value: nothing was measured in 7 samples and 0 orbits )"
            R"(that left the cell" )"
            R"(curves { name: "decay" points { time: 0 value: 1 standard_error: 0.25 limit: 1 )"
            R"(batches: 64 } points { time: 2 value: 0.5 } points { time: 4 value: 0.25 } } )"
            R"(curves { name: "profile" points { value: 2 position: 0 } )"
            R"(points { value: 1 position: 1.5 } })");
}

TEST(PointResult, ClosedFormsHaveModelErrorZeroAndARemarkNamesTheUnknownOnes) {
  const EnsembleSpec spec = SpecOf(&kEnergyRelaxation, PaperPoint(0.2), {}, Model::kSpectrum);
  const auto experiment = PointExperiment::Create(spec, 0, {Model::kSpectrum, "", std::nullopt});
  PointSummary summary;
  summary.estimates = {{.name = "time", .value = 1, .exact = 2},
                       {.name = "mean", .value = 3, .exact = 3}};
  const v1::PointResult result = ResultOf(0, *experiment, summary);
  EXPECT_THAT(result.remarks(),
              testing::ElementsAre("no bound of the model error is known for time"));
  EXPECT_THAT(result.estimates(1), testing::Property(&v1::Estimate::model_error, 0));
}

TEST(PointResult, EveryParameterHasAFieldAndComesBack) {
  PointParameters point;
  for (const Parameter* parameter : kParameters) {
    point.Set(*parameter, 3 + static_cast<double>(parameter->index));
  }
  point.Set(kCells, CodeOf({.columns = 4, .rows = 3, .is_lattice = true}));
  const v1::PointParameters message = ParametersMessage(point);
  EXPECT_EQ(
      message.ShortDebugString(),
      R"(rho: 3 delta: 4 epsilon: 5 exponent: 6 cells: "4x3" temperature: 8 hot: 9 cold: 10)");
  EXPECT_EQ(ParametersOf(message), point);
  EXPECT_EQ(ParametersMessage({{kRho, 0.6}, {kDelta, 0.1}}).ShortDebugString(),
            "rho: 0.6 delta: 0.1");
}

// Expected probabilities depend only on the parameters, and are not stored.
TEST(PointResult, ExpectedProbabilitiesAreComputedWhenRead) {
  const auto experiment = PointExperiment::Create(SpecOf(&kFirstHit, PaperPoint(0.1, 0.25, 1)), 0);
  BlockResult merged = experiment->EmptyResult();
  merged.histograms[0].counts[17] = 3;
  const v1::PointResult details = DetailsOf(experiment->Summarize(merged));
  EXPECT_EQ(details.histograms(0).expected_probabilities_size(), 0);
  const v1::PointResult result = PointResultOf(0, *experiment, merged, kFirstHit);
  double sum = 0;
  for (const v1::Histogram& histogram : result.histograms()) {
    EXPECT_EQ(histogram.expected_probabilities_size(), histogram.counts_size());
    for (const double probability : histogram.expected_probabilities()) sum += probability;
  }
  EXPECT_NEAR(sum, 1, 1e-12);  // rounding of a thousand summands
  EXPECT_EQ(result.histograms(0).counts(17), 3);
}

// A count takes a byte or two in the store. tests/fuzz (stored_result) and compressed_test.cc test
// that damage is noticed.
TEST(PointResult, StoredDetailsAreSmall) {
  v1::PointResult details;
  for (int i = 0; i < 2000; ++i) {
    if (i % 1000 == 0) details.add_histograms();
    details.mutable_histograms(i / 1000)->add_counts(500 + i * 37 % 101);
  }
  const std::string bytes = DetailsBytes(details);
  EXPECT_LT(bytes.size(), 2 * 2000u);
  EXPECT_EQ(DeterministicBytes(*DetailsFromBytes(bytes)), DeterministicBytes(details));
  EXPECT_TRUE(DetailsFromBytes("")->histograms().empty());
  EXPECT_THAT(DetailsFromBytes(bytes + "x"), StatusIs(absl::StatusCode::kDataLoss));
}

// The model's error is relative in an answer and absolute in a result. Only the first estimate has
// it, unless it is 0.
TEST(PointResult, TheModelsErrorAndReasonComeFromTheAnswer) {
  const EnsembleSpec spec = SpecOf(&kEnergyRelaxation, PaperPoint(0.1));
  const auto answered = [&](std::optional<double> error) {
    const auto experiment = PointExperiment::Create(
        spec, 0, {.model = Model::kSpectrum, .reason = "because", .model_error = error});
    return PointResultOf(0, *experiment, BlockResult());
  };
  const v1::PointResult off = answered(0.25);
  EXPECT_EQ(off.model(), v1::EnsembleSpec::SPECTRUM);
  EXPECT_EQ(off.reason(), "because");
  EXPECT_EQ(off.samples(), 0);
  EXPECT_EQ(off.estimates(0).model_error(), 0.25 * off.estimates(0).value());
  EXPECT_FALSE(off.estimates(1).has_model_error());
  EXPECT_EQ(answered(0.0).estimates(1).model_error(), 0);
  EXPECT_TRUE(answered(0.0).estimates(1).has_model_error());
  EXPECT_FALSE(answered(std::nullopt).estimates(0).has_model_error());
}

}  // namespace
}  // namespace ballpiston::server
