#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "core/experiment/all_experiments.h"
#include "core/gas/gas_shape.h"
#include "gmock/gmock.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/errors.h"
#include "server/convert/fold_record.h"
#include "server/convert/point_result.h"
#include "server/convert/spec.h"
#include "tests/server/error_details.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/spec_message.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

BlockResult SomeBlock() {
  BlockResult result;
  result.samples = 12345678901234;
  result.moments = {{3, 0.1, 1e-300, -2.5, 5e-324}, {}};
  result.batch_means = {{7, 0.3, -0.0, 1e300, 2, 3}};
  result.histograms = {{-1.5, 1.5, {0, 1, std::numeric_limits<uint64_t>::max()}}};
  result.health = {2, 1e-15};
  return result;
}

TEST(FoldRecord, ComesBackExactly) {
  const FoldState state = {.chunk = 2,
                           .blocks = 3,
                           .complete = SomeBlock(),
                           .partial = {},
                           .chunk_digests = {7, std::numeric_limits<uint64_t>::max()}};
  ASSERT_OK_AND_ASSIGN(const auto back, FoldStateFromBytes(FoldRecordBytes(state)));
  EXPECT_EQ(back.chunk, 2u);
  EXPECT_EQ(back.blocks, 3u);
  EXPECT_TRUE(back.complete == SomeBlock());
  EXPECT_TRUE(back.partial == BlockResult());
  EXPECT_EQ(back.chunk_digests, state.chunk_digests);
  EXPECT_TRUE(std::signbit(back.complete.batch_means[0].mean_denominator));
}

TEST(FoldRecord, GarbageIsDataLoss) {
  EXPECT_THAT(FoldStateFromBytes("\xff\xff\xff"), StatusIs(absl::StatusCode::kDataLoss));
}

class StoredFold : public testing::Test {
 protected:
  explicit StoredFold(const ExperimentKind& kind = kMarkovProperty)
      : experiment_(PointExperiment::Create({.experiment = &kind,
                                             .grid = {{kRho, {0.53}}, {kDelta, {0.1}}},
                                             .target = {.collisions = 1'000'000}},
                                            0)) {}

  absl::Status Checked(const FoldState& state) const { return CheckFoldState(*experiment_, state); }
  std::vector<uint64_t> Digests(uint64_t chunks) const { return std::vector<uint64_t>(chunks); }
  BlockResult Empty() const { return experiment_->EmptyResult(); }
  const ChunkPlan& plan() const { return experiment_->plan(); }

 private:
  std::unique_ptr<const PointExperiment> experiment_;
};

TEST_F(StoredFold, ThatLiesWithinThePlanIsAccepted) {
  EXPECT_OK(Checked({.blocks = 1, .partial = Empty()}));
  EXPECT_OK(Checked({.chunk = 1, .complete = Empty(), .chunk_digests = Digests(1)}));
  EXPECT_OK(Checked({.chunk = 1,
                     .blocks = 1,
                     .complete = Empty(),
                     .partial = Empty(),
                     .chunk_digests = Digests(1)}));
  EXPECT_OK(Checked(
      {.chunk = plan().chunks(), .complete = Empty(), .chunk_digests = Digests(plan().chunks())}));
}

TEST_F(StoredFold, ThatIsImpossibleForItsExperimentIsDataLoss) {
  BlockResult too_many = Empty(), no_error = Empty();
  too_many.samples = plan().BlockAt(0, 0).samples + 1;
  no_error.health.max_energy_error = kNan;
  for (const FoldState& state :
       {FoldState{},                                 // nothing merged yet
        FoldState{.chunk = 1, .complete = Empty()},  // a digest is missing
        FoldState{.chunk = plan().chunks() + 1,
        .complete = Empty(),
        .chunk_digests = Digests(plan().chunks() + 1)},
        FoldState{.chunk = plan().chunks(),
        .blocks = 1,
        .complete = Empty(),
        .partial = Empty(),
        .chunk_digests = Digests(plan().chunks())},
        FoldState{.blocks = plan().BlocksIn(0), .partial = Empty()},
        FoldState{.blocks = 1},                       // nothing merged
        FoldState{.complete = Empty()},               // something before the first chunk
        FoldState{.partial = Empty()},                // or before the first block
        FoldState{.blocks = 1, .partial = too_many},  // and so on
        FoldState{.blocks = 1, .partial = no_error}}) {
    EXPECT_THAT(Checked(state), StatusIs(absl::StatusCode::kDataLoss));
  }
}

TEST_F(StoredFold, ThatCountsASampleTwiceIsDataLoss) {
  BlockResult block = Empty();
  block.samples = 3;
  block.histograms[0].counts[0] = 1;
  block.histograms[0].counts[1] = 2;
  block.histograms[1].counts[0] = 3;
  EXPECT_OK(Checked({.blocks = 1, .partial = block}));
  block.histograms[1].counts[1] = 1;
  EXPECT_THAT(Checked({.blocks = 1, .partial = block}), StatusIs(absl::StatusCode::kDataLoss));
  block.histograms[1].counts[1] = std::numeric_limits<uint64_t>::max();  // the sum is 2
  EXPECT_THAT(Checked({.blocks = 1, .partial = block}), StatusIs(absl::StatusCode::kDataLoss));
}

v1::EnsembleSpec OneFirstHit() {
  v1::EnsembleSpec message;
  message.set_experiment(v1::EnsembleSpec::FIRST_HIT);
  message.mutable_grid()->add_rho(0.53);
  message.mutable_grid()->add_delta(0.1);
  message.mutable_grid()->add_epsilon(0.25);
  message.mutable_grid()->add_exponent(1);
  message.mutable_target()->set_samples(1000);
  message.set_seed(std::numeric_limits<uint64_t>::max());
  return message;
}

std::vector<std::string> ViolatedFields(const CheckedSpec& checked) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : checked.violations) fields.push_back(violation.field);
  return fields;
}

v1::EnsembleSpec OneGas(const std::string& estimate) {
  v1::EnsembleSpec message;
  message.set_experiment(v1::EnsembleSpec::GAS_EQUILIBRIUM);
  message.mutable_grid()->add_rho(0.53);
  message.mutable_grid()->add_delta(0.1);
  message.mutable_grid()->add_cells("4");
  message.mutable_grid()->add_temperature(1);
  message.mutable_target()->set_tolerance(0.05);
  message.mutable_target()->set_estimate(estimate);
  return message;
}

TEST(Spec, ComesBackUnchanged) {
  std::vector<v1::EnsembleSpec> messages(5, OneFirstHit());
  messages[0].set_model(v1::EnsembleSpec::BILLIARD_REFERENCE);
  messages[1].set_verify(true);
  messages[2].mutable_target()->Clear();  // an absent one comes back as an empty one
  messages[3].mutable_target()->set_collisions(5);
  messages[4].mutable_target()->mutable_budget()->set_nanos(300'000'000);
  for (const char* estimate : {"", "exchange_rate", "conductivity"}) {
    messages.push_back(OneGas(estimate));
  }
  for (const int nanos : {1, 7, 123'456'789, 999'999'999}) {  // a budget to the nanosecond
    for (const int seconds : {0, 1, 86'400}) {
      messages.push_back(OneFirstHit());
      messages.back().mutable_target()->set_tolerance(0.01);
      messages.back().mutable_target()->mutable_budget()->set_seconds(seconds);
      messages.back().mutable_target()->mutable_budget()->set_nanos(nanos);
    }
  }
  messages.push_back(OneGas(""));
  for (const char* shape : {"1", "12", "1x1", "4x3", "1000000", "1x1000000"}) {
    messages.back().mutable_grid()->add_cells(shape);
  }
  for (v1::EnsembleSpec& message : messages) {
    if (message.model() == v1::EnsembleSpec::MODEL_UNSPECIFIED) {
      message.set_model(v1::EnsembleSpec::AUTO);
    }
    message.set_precision(v1::EnsembleSpec::DOUBLE);
    EXPECT_EQ(SpecMessage(CheckSpec(message).spec).DebugString(), message.DebugString());
  }
  // Messages name the budget as it was given, not as 0.30000000000000004.
  EXPECT_EQ(CheckSpec(messages[4]).spec.target.budget_seconds, 0.3);
  const CheckedSpec shapes = CheckSpec(messages.back());
  EXPECT_EQ(shapes.spec.grid[kCells][4], CodeOf({.columns = 4, .rows = 3, .is_lattice = true}));
  EXPECT_EQ(ParametersMessage(PointAt(shapes.spec, 4)).cells(), "4x3");
}

// ---- violations ----

// Each field has one violation, in this order.
struct Violated {
  v1::EnsembleSpec spec;
  std::vector<std::string> fields;
  std::string description;  // of the first one; empty: not compared
};

v1::EnsembleSpec Changed(v1::EnsembleSpec spec,
                         const std::function<void(v1::EnsembleSpec&)>& change) {
  change(spec);
  return spec;
}

TEST(Spec, EveryBadFieldIsAViolation) {
  using Spec = v1::EnsembleSpec;
  const std::string range = "permitted: N or NxM, 1 to 1000000 cells in all";
  std::vector<Violated> rows;
  const auto add = [&rows](const Spec& spec, std::vector<std::string> fields,
                           std::string text = "") {
    rows.push_back({spec, std::move(fields), std::move(text)});
  };
  for (const char* text : {"4y4", "0", "x", "1e9", "-3", "", "1001x1000", "4x"}) {
    add(Changed(OneGas(""), [&](Spec& s) { s.mutable_grid()->set_cells(0, text); }),
        {"spec.grid.cells[0]"}, "cells is \"" + std::string(text) + "\"; " + range);
  }
  // Strange text is escaped and shortened.
  add(Changed(OneGas(""), [](Spec& s) { s.mutable_grid()->set_cells(0, "\x1b[2J"); }),
      {"spec.grid.cells[0]"}, "cells is \"\\033[2J\"; " + range);
  add(Changed(OneGas(""),
              [](Spec& s) { s.mutable_grid()->set_cells(0, std::string(1'000'000, 'y')); }),
      {"spec.grid.cells[0]"}, "cells is \"" + std::string(100, 'y') + "...\"; " + range);
  add(OneGas("\x1b[2J" + std::string(1'000'000, 'y')), {"spec.target.estimate"},
      "is \\033[2J" + std::string(96, 'y') +
          "...; permitted with gas-equilibrium: exchange_rate, conductivity");
  add(Changed(OneFirstHit(), [](Spec& s) { s.mutable_grid()->add_cells("4"); }),
      {"spec.grid.cells"}, "has 1 values; first-hit does not use this list");
  for (const double wrong : {kNan, kInfinity, -kInfinity}) {
    add(Changed(OneFirstHit(), [&](Spec& s) { s.mutable_grid()->add_rho(wrong); }),
        {"spec.grid.rho[1]"});
    add(Changed(OneFirstHit(), [&](Spec& s) { s.mutable_target()->set_tolerance(wrong); }),
        {"spec.target.tolerance"});
  }
  add(Changed(OneFirstHit(), [](Spec& s) { s.set_precision(static_cast<Spec::Precision>(79)); }),
      {"spec.precision"});
  add(Changed(OneFirstHit(), [](Spec& s) { s.set_model(static_cast<Spec::Model>(78)); }),
      {"spec.model"});
  add(Changed(OneFirstHit(), [](Spec& s) { s.set_experiment(static_cast<Spec::Experiment>(77)); }),
      {"spec.experiment"});
  add(Changed(OneFirstHit(),
              [](Spec& s) { s.GetReflection()->MutableUnknownFields(&s)->AddVarint(100, 1); }),
      {"spec"});
  // A tolerance below the model's own error.
  const Spec relaxation = Changed(OneFirstHit(), [](Spec& s) {
    s.set_experiment(Spec::ENERGY_RELAXATION);
    s.mutable_grid()->clear_epsilon();
    s.mutable_grid()->clear_exponent();
    s.mutable_target()->set_tolerance(1e-4);
  });
  for (const auto model : {Spec::MARKOV, Spec::SPECTRUM}) {
    add(Changed(relaxation, [&](Spec& s) { s.set_model(model); }), {"spec.target.tolerance"});
  }
  for (const auto model : {Spec::AUTO, Spec::BILLIARD}) {
    add(Changed(relaxation, [&](Spec& s) { s.set_model(model); }), {});
  }
  for (const Violated& row : rows) {
    const CheckedSpec checked = CheckSpec(row.spec);
    EXPECT_THAT(ViolatedFields(checked), testing::ElementsAreArray(row.fields));
    if (row.description.empty()) continue;
    EXPECT_EQ(checked.violations.at(0).description, row.description);
  }
}

TEST(Spec, DefaultValuesAreWrittenIntoEmptyLists) {
  v1::EnsembleSpec gas;
  gas.set_experiment(v1::EnsembleSpec::GAS_EQUILIBRIUM);
  gas.mutable_grid()->add_rho(0.53);
  v1::EnsembleSpec given = gas;
  AddDefaults(gas);
  EXPECT_THAT(gas.grid().temperature(), testing::ElementsAre(1));
  given.mutable_grid()->add_temperature(2);
  AddDefaults(given);
  EXPECT_THAT(given.grid().temperature(), testing::ElementsAre(2));
  v1::EnsembleSpec pair = OneFirstHit();
  AddDefaults(pair);
  EXPECT_EQ(pair.SerializeAsString(), OneFirstHit().SerializeAsString());
}

// Each experiment with every model that answers it, and no other.
TEST(Spec, EveryValueOfEveryEnumerationComesBack) {
  const auto* experiments = v1::EnsembleSpec::Experiment_descriptor();
  const auto* models = v1::EnsembleSpec::Model_descriptor();
  std::set<const ExperimentKind*> seen_experiments;
  std::set<Model> seen_models;
  for (int e = 0; e < experiments->value_count(); ++e) {
    for (int m = 0; m < models->value_count(); ++m) {
      v1::EnsembleSpec message = OneFirstHit();
      message.set_experiment(
          static_cast<v1::EnsembleSpec::Experiment>(experiments->value(e)->number()));
      message.set_model(static_cast<v1::EnsembleSpec::Model>(models->value(m)->number()));
      message.set_precision(v1::EnsembleSpec::SINGLE);
      const CheckedSpec checked = CheckSpec(message);
      for (const FieldViolation& violation : checked.violations) {
        EXPECT_THAT(violation.description, Not(HasSubstr("is not a value this server knows")));
      }
      seen_experiments.insert(checked.spec.experiment);
      seen_models.insert(checked.spec.model);
      const v1::EnsembleSpec back = SpecMessage(checked.spec);
      EXPECT_EQ(back.experiment(), message.experiment());
      EXPECT_EQ(back.precision(), v1::EnsembleSpec::SINGLE);
      if (message.model() != v1::EnsembleSpec::MODEL_UNSPECIFIED) {
        EXPECT_EQ(back.model(), message.model());
      }
    }
  }
  EXPECT_EQ(seen_experiments.size(), static_cast<size_t>(experiments->value_count()));
  EXPECT_EQ(seen_experiments.size(), AllExperiments().size() + 1);  // and the missing one
  EXPECT_EQ(seen_models.size(), static_cast<size_t>(models->value_count()) - 1);  // AUTO twice
}

TEST(Spec, ExperimentsHaveOneName) {
  for (const ExperimentKind* kind : AllExperiments()) {
    const auto* value = v1::EnsembleSpec::Experiment_descriptor()->FindValueByNumber(
        static_cast<int>(kind->number));
    ASSERT_NE(value, nullptr) << kind->name;
    std::string name = absl::AsciiStrToLower(value->name());
    std::replace(name.begin(), name.end(), '_', '-');
    EXPECT_EQ(name, kind->name);
  }
}

TEST(Spec, EveryParameterHasAFieldInPoints) {
  PointParameters point;
  for (const Parameter* parameter : kParameters) {
    point.Set(*parameter, 3 + static_cast<double>(parameter->index));
  }
  const v1::PointParameters message = ParametersMessage(point);
  EXPECT_EQ(message.rho(), 3);
  EXPECT_EQ(message.delta(), 4);
  EXPECT_EQ(message.epsilon(), 5);
  EXPECT_EQ(message.exponent(), 6);
  EXPECT_EQ(message.cells(), "7");
  EXPECT_EQ(message.temperature(), 8);
  EXPECT_EQ(message.hot(), 9);
  EXPECT_EQ(message.cold(), 10);
  const v1::PointParameters pair = ParametersMessage({{kRho, 0.6}, {kDelta, 0.1}});
  EXPECT_FALSE(pair.has_cells() || pair.has_temperature() || pair.has_hot() || pair.has_cold());
}

// A message of 4 MiB holds two million empty texts.
TEST(Spec, ATooLongListOfShapesIsNotParsed) {
  v1::EnsembleSpec message = OneFirstHit();
  for (int i = 0; i <= kMaxPoints; ++i) message.mutable_grid()->add_cells("");
  EXPECT_THAT(ViolatedFields(CheckSpec(message)),
              testing::UnorderedElementsAre("spec.grid", "spec.grid.cells"));
  message.mutable_grid()->mutable_cells()->RemoveLast();
  EXPECT_EQ(CheckSpec(message).violations.size(), static_cast<size_t>(kMaxPoints) + 1);
}

// A message of 4 MiB may hold two million of them.
TEST(Spec, AtMostSomeUnknownFieldsAreListed) {
  v1::EnsembleSpec message = OneFirstHit();
  for (int i = 0; i < 10'000; ++i) {
    message.GetReflection()->MutableUnknownFields(&message)->AddVarint(100, 1);
  }
  const size_t told = CheckSpec(message).violations.size();
  EXPECT_GE(told, 1u);
  EXPECT_LE(told, 1000u);
}

v1::PointResult PointResultOf(size_t index, const PointExperiment& experiment,
                              const BlockResult& merged) {
  const PointSummary summary = experiment.Summarize(merged);
  return WithDetails(ResultOf(index, experiment, summary), DetailsOf(summary), kEquilibrium);
}

TEST(PointResult, ValuesThatDoNotExistAreLeftOut) {
  const EnsembleSpec spec = FakeSpec(1, 1);
  const auto experiment = FakeExperiments()(spec, 0);
  BlockResult merged;
  merged.samples = 1;
  merged.moments.resize(1);
  merged.moments[0].Add(0.25);  // one sample: no standard error, no z-score
  merged.health.max_energy_error = kNan;
  const v1::PointResult result = PointResultOf(3, *experiment, merged);
  ASSERT_EQ(result.estimates_size(), 1);
  EXPECT_EQ(result.index(), 3);
  EXPECT_EQ(result.estimates(0).value(), 0.25);
  EXPECT_FALSE(result.estimates(0).has_standard_error());
  EXPECT_FALSE(result.estimates(0).has_z_score());
  EXPECT_TRUE(result.estimates(0).has_exact());
  EXPECT_EQ(result.health().max_energy_error(), 0);
  EXPECT_FALSE(result.parameters().has_epsilon());
  merged.moments[0].mean = kNan;
  EXPECT_EQ(PointResultOf(3, *experiment, merged).estimates_size(), 0);
}

// An answer with everything that a result can hold.
PointExperiment FullAnswer() {
  PointSummary summary;
  summary.estimates = {
      {.name = "time", .value = -4, .standard_error = 0.5, .batches = 64, .limit = 3},
      {.name = "distance", .value = 0.25, .noise_floor = 0.125},
      {.name = "odd", .value = 1, .limit = kNan, .noise_floor = kInfinity}};
  summary.curves = {{"decay", {{0, 1, 0.25, 1}, {2, 0.5, {}, {}}, {4, 0.25, kNan, kInfinity}}},
                    {"profile", {{0, 2}, {1.5, 1}}, CurveAxis::kPosition}};
  summary.remarks = {"the run was too short", "another sentence"};
  const EnsembleSpec spec = FakeSpec(1, 1);
  return PointExperiment(spec, PointAt(spec, 0), summary);
}

TEST(PointResult, LimitsNoiseFloorsCurvesAndRemarksAreKept) {
  const v1::PointResult result = PointResultOf(0, FullAnswer(), BlockResult());
  ASSERT_EQ(result.estimates_size(), 3);
  EXPECT_EQ(result.estimates(0).limit(), 3);
  EXPECT_EQ(result.estimates(0).batches(), 64);
  EXPECT_FALSE(result.estimates(1).has_batches());
  EXPECT_FALSE(result.estimates(0).has_noise_floor());
  EXPECT_EQ(result.estimates(1).noise_floor(), 0.125);
  EXPECT_FALSE(result.estimates(1).has_limit());
  EXPECT_FALSE(result.estimates(2).has_limit());
  EXPECT_FALSE(result.estimates(2).has_noise_floor());
  ASSERT_EQ(result.curves_size(), 2);
  EXPECT_EQ(result.curves(0).name(), "decay");
  ASSERT_EQ(result.curves(0).points_size(), 3);
  EXPECT_EQ(result.curves(0).points(0).standard_error(), 0.25);
  EXPECT_EQ(result.curves(0).points(0).limit(), 1);
  EXPECT_EQ(result.curves(0).points(1).time(), 2);
  EXPECT_EQ(result.curves(0).points(1).value(), 0.5);
  for (const int i : {1, 2}) {
    EXPECT_FALSE(result.curves(0).points(i).has_standard_error());
    EXPECT_FALSE(result.curves(0).points(i).has_limit());
  }
  EXPECT_FALSE(result.curves(0).points(1).has_position());
  EXPECT_EQ(result.curves(1).points(1).position(), 1.5);
  EXPECT_FALSE(result.curves(1).points(1).has_time());
  EXPECT_THAT(result.remarks(), testing::ElementsAre("the run was too short", "another sentence"));
}

TEST(PointResult, ParametersComeBackFromTheirMessage) {
  PointParameters point = {{kRho, 0.53}, {kDelta, 0.1}, {kTemperature, 2}};
  point.Set(kCells, CodeOf({.columns = 4, .rows = 3, .is_lattice = true}));
  const v1::PointParameters message = ParametersMessage(point);
  EXPECT_EQ(message.cells(), "4x3");
  EXPECT_EQ(ParametersOf(message), point);
}

// Expected probabilities depend only on the parameters, and are not stored.
TEST(PointResult, ExpectedProbabilitiesAreComputedWhenRead) {
  const CheckedSpec checked = CheckSpec(OneFirstHit());
  const auto experiment = PointExperiment::Create(checked.spec, 0);
  BlockResult merged = experiment->EmptyResult();
  merged.histograms[0].counts[17] = 3;
  const PointSummary summary = experiment->Summarize(merged);
  const v1::PointResult details = DetailsOf(summary);
  EXPECT_EQ(details.histograms(0).expected_probabilities_size(), 0);
  const v1::PointResult result = WithDetails(ResultOf(0, *experiment, summary), details, kFirstHit);
  double sum = 0;
  for (const v1::Histogram& histogram : result.histograms()) {
    ASSERT_EQ(histogram.expected_probabilities_size(), histogram.counts_size());
    for (const double probability : histogram.expected_probabilities()) sum += probability;
  }
  EXPECT_EQ(result.histograms(0).counts(17), 3);
  EXPECT_NEAR(sum, 1, 1e-12);  // rounding of a thousand summands
}

// A count takes a byte or two in the store.
TEST(PointResult, StoredDetailsAreSmallAndTheirDamageIsNoticed) {
  v1::PointResult details;
  for (int i = 0; i < 2000; ++i) {
    if (i % 1000 == 0) details.add_histograms();
    details.mutable_histograms(i / 1000)->add_counts(500 + i * 37 % 101);
  }
  const std::string bytes = DetailsBytes(details);
  EXPECT_LT(bytes.size(), 2 * 2000u);
  EXPECT_EQ(DeterministicBytes(*DetailsFromBytes(bytes)), DeterministicBytes(details));
  EXPECT_TRUE(DetailsFromBytes("")->histograms().empty());
  for (size_t i = 0; i < bytes.size(); i += 50) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 1);
    EXPECT_TRUE(absl::IsDataLoss(DetailsFromBytes(damaged).status())) << i;
  }
  for (size_t length = 1; length < bytes.size(); ++length) {
    EXPECT_TRUE(absl::IsDataLoss(DetailsFromBytes(bytes.substr(0, length)).status())) << length;
  }
  EXPECT_TRUE(absl::IsDataLoss(DetailsFromBytes(bytes + "x").status()));
}

// The model's error is relative in an answer and absolute in a result. Only the first estimate has
// it, unless it is 0.
TEST(PointResult, TheModelsErrorAndReasonComeFromTheAnswer) {
  EnsembleSpec spec;
  spec.experiment = &kEnergyRelaxation;
  spec.grid = {{kRho, {0.53}}, {kDelta, {0.1}}};
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

google::rpc::Status RpcStatusOf(const grpc::Status& status) {
  google::rpc::Status details;
  EXPECT_TRUE(details.ParseFromString(status.error_details()));
  return details;
}

TEST(Errors, CarryReasonAndDomain) {
  const grpc::Status status = GrpcStatus(JobNotFound("ensembleJobs/x"));
  EXPECT_THAT(status, StatusIs(grpc::StatusCode::NOT_FOUND, HasSubstr("ensembleJobs/x")));
  const google::rpc::Status details = RpcStatusOf(status);
  EXPECT_EQ(details.code(), grpc::StatusCode::NOT_FOUND);
  google::rpc::ErrorInfo info;
  ASSERT_EQ(details.details_size(), 1);
  ASSERT_TRUE(details.details(0).UnpackTo(&info));
  EXPECT_EQ(info.reason(), "JOB_NOT_FOUND");
  EXPECT_EQ(info.domain(), "ballpiston");
  EXPECT_EQ(info.metadata().at("name"), "ensembleJobs/x");
}

google::rpc::RetryInfo RetryOf(const absl::Status& status) {
  const google::rpc::Status error = RpcStatus(status);
  google::rpc::RetryInfo retry;
  for (const auto& detail : error.details()) detail.UnpackTo(&retry);
  return retry;
}

TEST(Errors, SayHowLongToWaitWhereWaitingHelps) {
  const auto limit = [](const std::string& reason) { return LimitExceeded(reason, "it", "f", 1); };
  for (const absl::Status& cured :
       {ShuttingDown(), StoreFailure(absl::ResourceExhaustedError("full")),
        StoreFailure(absl::UnavailableError("fails")), limit("TOO_MANY_CALLS"),
        limit("TOO_MANY_STREAMS"), limit("TOO_MANY_JOBS"), limit("TOO_MANY_ACTIVE_POINTS"),
        limit("QUEUE_FULL")}) {
    EXPECT_GT(RetryOf(cured).retry_delay().seconds(), 0) << cured;
    EXPECT_EQ(RetryDelayOf(RpcStatus(cured)),
              absl::Seconds(RetryOf(cured).retry_delay().seconds()));
  }
  for (const absl::Status& lasting :
       {limit("TOO_MANY_POINTS"), limit("TOO_MANY_SAMPLES"), limit("TOO_MANY_STORED_BYTES"),
        StoreFailure(absl::DataLossError("damaged")), JobNotFound("x")}) {
    EXPECT_FALSE(RetryOf(lasting).has_retry_delay()) << lasting;
    EXPECT_EQ(RetryDelayOf(RpcStatus(lasting)), absl::ZeroDuration());
  }
}

TEST(Errors, AToleranceThatWasNotReachedNamesPointToleranceBudgetAndError) {
  EnsembleSpec spec = FakeSpec(1, 0);
  spec.target = {.tolerance = 1e-6, .budget_seconds = 0.25};
  const absl::Status missed =
      ToleranceNotReached(spec, 17, {.name = "time", .value = -8, .standard_error = 0.04});
  EXPECT_THAT(missed,
              StatusIs(absl::StatusCode::kDeadlineExceeded,
                       "point 17: tolerance 1e-06 was not reached within the budget of 0.25 s: "
                       "reached 0.005"));
  const absl::Status without = ToleranceNotReached(spec, 0, {.name = "time", .value = 8});
  EXPECT_THAT(std::string(without.message()), HasSubstr("reached an unknown error"));
  // A job's error keeps its reason. An error without a reason gets that of a failed computation.
  EXPECT_EQ(ReasonOf(WithDefaultReason(missed, "COMPUTATION_FAILED")), "TOLERANCE_NOT_REACHED");
  EXPECT_EQ(ReasonOf(WithDefaultReason(absl::InternalError("lost"), "COMPUTATION_FAILED")),
            "COMPUTATION_FAILED");
}

TEST(Errors, ViolationsThatDoNotFitAreCounted) {
  std::vector<FieldViolation> violations;
  for (int i = 0; i < 5000; ++i) {
    violations.push_back({"spec.grid.rho[" + std::to_string(i) + "]", std::string(90, 'x')});
  }
  const grpc::Status status = GrpcStatus(InvalidSpec(violations));
  EXPECT_LT(status.error_details().size(), kMaxErrorDetails);
  google::rpc::ErrorInfo info;
  google::rpc::BadRequest request;
  const google::rpc::Status details = RpcStatusOf(status);
  for (const auto& detail : details.details()) {
    detail.UnpackTo(&info);
    detail.UnpackTo(&request);
  }
  EXPECT_GT(request.field_violations_size(), 20);
  EXPECT_EQ(info.metadata().at("violations_left_out"),
            std::to_string(5000 - request.field_violations_size()));
  EXPECT_THAT(status.error_message(), HasSubstr(info.metadata().at("violations_left_out")));
}

TEST(Errors, TextIsCutBetweenCharacters) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "\xc3\xa9";  // e with an accent
  const grpc::Status status = GrpcStatus(InvalidRequest({{"a", text}}));
  EXPECT_TRUE(RpcStatusOf(status).IsInitialized());
  const std::string message = status.error_message();
  EXPECT_NE(message.find("\xa9..."), std::string::npos);
}

}  // namespace
}  // namespace ballpiston::server
