#include "server/worker/lease_record.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/engine_version.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_fold.h"
#include "core/ensemble/random_stream.h"
#include "core/experiment/all_experiments.h"
#include "gmock/gmock.h"
#include "server/convert/fold_record.h"
#include "tests/server/worker/sample_leases.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Through the bytes of the record.
absl::StatusOr<IdentifiedLease> ReadBack(const IdentifiedLease& lease) {
  storage::Lease record;
  if (!record.ParseFromString(LeaseRecord(lease.lease, lease.job).SerializeAsString())) {
    return absl::InternalError("the record cannot be parsed");
  }
  return LeaseOfRecord(record);
}

// The bits of the first samples. A whole block of an open-ended target would take much longer.
std::string FirstSamples(const PointExperiment& experiment) {
  Block block = experiment.plan().BlockAt(0, 0);
  block.samples = std::min<uint64_t>(block.samples, 64);
  return ChunkRecordBytes({0, RunBlock(experiment, block).value()});
}

void ExpectSamePlan(const ChunkPlan& a, const ChunkPlan& b) {
  EXPECT_EQ(a.samples(), b.samples());
  EXPECT_EQ(a.events_per_sample(), b.events_per_sample());
  ASSERT_EQ(a.chunks(), b.chunks());
  // Sizes double from chunk to chunk, up to a maximum. So the first chunks and the last chunk show
  // all sizes. An open-ended target has far more chunks.
  constexpr uint64_t kFirst = 100;
  for (uint64_t chunk = 0; chunk < std::min(kFirst, a.chunks()); ++chunk) {
    EXPECT_EQ(a.BlocksIn(chunk), b.BlocksIn(chunk));
    EXPECT_EQ(a.BlockAt(chunk, 0), b.BlockAt(chunk, 0));
  }
  const uint64_t last = a.chunks() - 1;
  EXPECT_EQ(a.BlocksIn(last), b.BlocksIn(last));
  EXPECT_EQ(a.BlockAt(last, 0), b.BlockAt(last, 0));
}

void ExpectSameExperiment(const Lease& original, const Lease& back) {
  const PointExperiment &a = *original.experiment, &b = *back.experiment;
  EXPECT_EQ(a.parameters(), b.parameters());
  EXPECT_EQ(a.answer().model, b.answer().model);
  EXPECT_EQ(
      PointStream(OnePointSpec(*original.spec, a.parameters(), a.answer().model), a.parameters()),
      PointStream(*back.spec, b.parameters()));
  EXPECT_EQ(back.spec->seed, original.spec->seed);
  EXPECT_EQ(back.spec->target.estimate, original.spec->target.estimate);
  EXPECT_EQ(a.expected_chunks(), b.expected_chunks());
  ExpectSamePlan(a.plan(), b.plan());
  EXPECT_EQ(FirstSamples(a), FirstSamples(b));
}

void ExpectComesBack(const IdentifiedLease& lease) {
  ASSERT_OK_AND_ASSIGN(const IdentifiedLease back, ReadBack(lease));
  EXPECT_EQ(back.job, lease.job);
  EXPECT_EQ(back.lease.point, lease.lease.point);
  EXPECT_EQ(back.lease.attempt, lease.lease.attempt);
  EXPECT_EQ(back.lease.crashes, lease.lease.crashes);
  EXPECT_EQ(back.lease.start.chunk, lease.lease.start.chunk);
  EXPECT_EQ(back.lease.start.blocks, lease.lease.start.blocks);
  EXPECT_EQ(back.lease.start.merged, lease.lease.start.merged);
  EXPECT_EQ(back.lease.end, lease.lease.end);
  ExpectSameExperiment(lease.lease, back.lease);
}

TEST(LeaseRecord, EveryQuestionKeepsItsPlanAndItsBits) {
  for (EnsembleSpec spec : EverySampledSpec()) {
    SCOPED_TRACE(NameOf(spec));
    ExpectComesBack(LeaseOf(spec));
    spec.target = {};
    ExpectComesBack(LeaseOf(spec));
    spec.target.tolerance = 0.1;
    if (Violations(spec).empty()) ExpectComesBack(LeaseOf(spec));
  }
  EnsembleSpec single = SpecOf(kEquilibrium, Model::kBilliard);
  single.precision = Precision::kSingle;
  ExpectComesBack(LeaseOf(single));
  EnsembleSpec named = SpecOf(kGasEquilibrium, Model::kBilliard, 150);
  named.target.estimate = "conductivity";  // by which the worker judges a tolerance
  ExpectComesBack(LeaseOf(named));
}

TEST(LeaseRecord, APartOfAPointOfAGridComesBack) {
  EnsembleSpec spec = SpecOf(kMarkovProperty, Model::kBilliard, 1'000'000);
  spec.grid[kDelta] = {0.1, 0.07, 1.0 / 30};
  IdentifiedLease lease = LeaseOf(spec, 1);
  lease.lease.point = 2;
  lease.lease.experiment = PointExperiment::Create(spec, 2);
  const PointExperiment& experiment = *lease.lease.experiment;
  lease.lease.end = experiment.plan().chunks();
  lease.lease.start.blocks = 2;
  for (uint64_t i = 0; i < 2; ++i) {
    lease.lease.start.merged.Merge(RunBlock(experiment, experiment.plan().BlockAt(1, i)).value());
  }
  ExpectComesBack(lease);
}

// Of a spec in single precision AUTO may choose the jump process. The plan depends on the
// precision.
TEST(LeaseRecord, TheJumpProcessInSinglePrecisionComesBack) {
  EnsembleSpec spec = SpecOf(kEnergyRelaxation, Model::kAuto);
  spec.precision = Precision::kSingle;
  spec.verify = true;
  IdentifiedLease lease = LeaseOf(spec);
  lease.lease.experiment = PointExperiment::Create(spec, 0, {.model = Model::kMarkov});
  lease.lease.end = lease.lease.experiment->plan().chunks();
  ExpectComesBack(lease);
}

// ---- damage ----

struct Damage {
  std::string field;
  std::function<void(storage::Lease&)> harm;
};

storage::Lease GoodRecord() {
  const IdentifiedLease lease = LeaseOf(SpecOf(kFirstHit, Model::kBilliard));
  return LeaseRecord(lease.lease, lease.job);
}

storage::Value& ValueOf(storage::Lease& record, const Parameter& parameter) {
  for (storage::Value& value : *record.mutable_question()->mutable_point()) {
    if (value.parameter() == parameter.index) return value;
  }
  return *record.mutable_question()->add_point();
}

void ExpectRefused(const Damage& damage) {
  storage::Lease record = GoodRecord();
  damage.harm(record);
  EXPECT_THAT(LeaseOfRecord(record),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("field " + damage.field)));
}

TEST(LeaseRecord, ADamagedQuestionIsDataLossWithItsField) {
  using Record = storage::Lease;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  ASSERT_OK(LeaseOfRecord(GoodRecord()));
  for (const Damage& damage : std::vector<Damage>{
           {"question.experiment", [](Record& r) { r.clear_question(); }},
           {"question.experiment", [](Record& r) { r.mutable_question()->set_experiment(999); }},
           {"question.model", [](Record& r) { r.mutable_question()->clear_model(); }},
           {"question.model",
            [](Record& r) {
              r.mutable_question()->set_model(static_cast<storage::Question::Model>(77));
            }},
           {"question.model",
            [](Record& r) { r.mutable_question()->set_model(storage::Question::MARKOV); }},
           {"question.single_precision",
            [](Record& r) {
              r.mutable_question()->set_model(storage::Question::BILLIARD_REFERENCE);
              r.mutable_question()->set_single_precision(true);
            }},
           {"question.point.parameter",
            [](Record& r) {
              r.mutable_question()->add_point()->set_parameter(kParameters.size());
            }},
           {"question.point",
            [](Record& r) { r.mutable_question()->add_point()->set_parameter(0); }},
           {"question.grid.rho", [](Record& r) { ValueOf(r, kRho).set_value(kNan); }},
           {"question.grid.delta", [](Record& r) { ValueOf(r, kDelta).set_value(-1); }},
           {"question.grid.delta", [](Record& r) { ValueOf(r, kDelta).set_value(0.49); }},
           {"question.grid.epsilon", [](Record& r) { ValueOf(r, kEpsilon).set_value(0.6); }},
           {"question.grid.rho", [](Record& r) { r.mutable_question()->clear_point(); }},
           {"question.grid.cells",
            [](Record& r) { r.mutable_question()->add_point()->set_parameter(kCells.index); }},
           {"question.target.samples", [](Record& r) { r.mutable_question()->set_samples(0); }},
           {"question.target.samples", [](Record& r) { r.mutable_question()->set_samples(-7); }},
           {"question.target.collisions",
            [](Record& r) { r.mutable_question()->set_collisions(9); }},
           {"question.target.estimate",
            [](Record& r) { r.mutable_question()->set_estimate("conductivity"); }},
           {"question.target.tolerance",
            [](Record& r) { r.mutable_question()->set_tolerance(kNan); }},
       }) {
    SCOPED_TRACE(damage.field);
    ExpectRefused(damage);
  }
}

TEST(LeaseRecord, DamagedChunksAreDataLossWithTheirField) {
  using Record = storage::Lease;
  for (const Damage& damage :
       std::vector<Damage>{{"point", [](Record& r) { r.set_point(-1); }},
                           {"point", [](Record& r) { r.set_point(kMaxPoints); }},
                           {"attempt", [](Record& r) { r.set_attempt(0); }},
                           {"crashes", [](Record& r) { r.set_crashes(-1); }},
                           {"first_chunk", [](Record& r) { r.set_first_chunk(~uint64_t{0}); }},
                           {"first_chunk", [](Record& r) { r.set_first_chunk(r.end_chunk()); }},
                           {"end_chunk", [](Record& r) { r.set_end_chunk(0); }},
                           {"end_chunk", [](Record& r) { r.set_end_chunk(r.end_chunk() + 1); }},
                           {"blocks", [](Record& r) { r.set_blocks(~uint64_t{0}); }},
                           {"partial", [](Record& r) { r.set_blocks(1); }},
                           {"partial", [](Record& r) { r.mutable_partial()->set_samples(1); }},
                           {"partial", [](Record& r) {
                              r.set_blocks(1);
                              r.mutable_partial()->set_samples(~uint64_t{0});
                            }}}) {
    SCOPED_TRACE(damage.field);
    ExpectRefused(damage);
  }
}

TEST(LeaseRecord, AnotherEngineVersionIsRefusedWithBothVersions) {
  storage::Lease record = GoodRecord();
  record.set_engine_version("0.0.1");
  record.clear_question();  // the other engine may have other questions
  EXPECT_THAT(LeaseOfRecord(record),
              StatusIs(absl::StatusCode::kUnimplemented,
                       AllOf(HasSubstr("0.0.1"), HasSubstr(kEngineVersion))));
}

}  // namespace
}  // namespace ballpiston::server
