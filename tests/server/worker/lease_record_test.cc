#include "server/worker/lease_record.h"

#include "core/engine_version.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_fold.h"
#include "core/ensemble/random_stream.h"
#include "core/experiment/all_experiments.h"
#include "server/convert/fold_record.h"
#include "tests/server/worker/sample_leases.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

// Through the bytes of the record.
absl::StatusOr<LeaseFile> ReadBack(const Lease& lease) {
  storage::Lease record;
  if (!record.ParseFromString(LeaseRecord(lease, "a server", 2.5).SerializeAsString())) {
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

void ExpectComesBack(const Lease& lease) {
  ASSERT_OK_AND_ASSIGN(const LeaseFile file, ReadBack(lease));
  EXPECT_EQ(file.server, "a server");
  EXPECT_EQ(file.touch_seconds, 2.5);
  const Lease& back = file.lease;
  EXPECT_EQ(back.run, lease.run);
  EXPECT_EQ(back.generation, lease.generation);
  EXPECT_EQ(back.point, lease.point);
  EXPECT_EQ(back.start.chunk, lease.start.chunk);
  EXPECT_EQ(back.start.blocks, lease.start.blocks);
  EXPECT_EQ(back.start.merged, lease.start.merged);
  EXPECT_EQ(back.end, lease.end);
  ExpectSameExperiment(lease, back);
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
  EnsembleSpec outside = SpecOf(kEnergyRelaxation, Model::kMarkov);  // of the billiard's domain
  outside.grid[kDelta] = {1e-12};
  ExpectComesBack(LeaseOf(outside));
  EnsembleSpec named = SpecOf(kGasEquilibrium, Model::kBilliard, 150);
  named.target.estimate = "conductivity";  // by which the worker judges a tolerance
  ExpectComesBack(LeaseOf(named));
}

TEST(LeaseRecord, APartOfAPointOfAGridComesBack) {
  EnsembleSpec spec = SpecOf(kMarkovProperty, Model::kBilliard, 1'000'000);
  spec.grid[kDelta] = {0.1, 0.07, 1.0 / 30};
  Lease lease = LeaseOf(spec, 1);
  lease.point = 2;
  lease.experiment = PointExperiment::Create(spec, 2);
  const PointExperiment& experiment = *lease.experiment;
  lease.end = experiment.plan().chunks();
  lease.start.blocks = 2;
  for (uint64_t i = 0; i < 2; ++i) {
    lease.start.merged.Merge(RunBlock(experiment, experiment.plan().BlockAt(1, i)).value());
  }
  ExpectComesBack(lease);
}

// Of a spec in single precision AUTO may choose the jump process. The plan depends on the
// precision.
TEST(LeaseRecord, TheJumpProcessInSinglePrecisionComesBack) {
  EnsembleSpec spec = SpecOf(kEnergyRelaxation, Model::kAuto);
  spec.precision = Precision::kSingle;
  spec.verify = true;
  Lease lease = LeaseOf(spec);
  lease.experiment = PointExperiment::Create(spec, 0, {.model = Model::kMarkov});
  lease.end = lease.experiment->plan().chunks();
  ExpectComesBack(lease);
}

// ---- damage ----

using Harm = std::function<void(storage::Lease&)>;

storage::Lease GoodRecord() { return RecordOf(LeaseOf(SpecOf(kFirstHit, Model::kBilliard))); }

void ExpectRefused(const std::vector<Harm>& harms) {
  ASSERT_OK(LeaseOfRecord(GoodRecord()));
  for (size_t i = 0; i < harms.size(); ++i) {
    SCOPED_TRACE(i);
    storage::Lease record = GoodRecord();
    harms[i](record);
    EXPECT_THAT(LeaseOfRecord(record), StatusIs(absl::StatusCode::kDataLoss));
  }
}

// A question whose parameter has this value.
Harm With(const Parameter& parameter, double value) {
  return [&parameter, value](storage::Lease& record) {
    (*record.mutable_question()->mutable_values())[static_cast<uint32_t>(parameter.index)] = value;
  };
}

TEST(LeaseRecord, AnImpossibleQuestionIsDataLoss) {
  using Record = storage::Lease;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto with_model = [](Model model) {
    return [model](Record& r) { r.mutable_question()->set_model(static_cast<uint32_t>(model)); };
  };
  ExpectRefused({
      [](Record& r) { r.clear_question(); },
      [](Record& r) { r.mutable_question()->set_experiment(999); },
      [](Record& r) { r.mutable_question()->set_model(77); },
      with_model(Model::kAuto),
      with_model(Model::kClosedForm),
      with_model(Model::kMarkov),
      [](Record& r) { (*r.mutable_question()->mutable_values())[kParameters.size()] = 1; },
      With(kRho, kNan),
      With(kDelta, -1),
      With(kDelta, 0.49),
      With(kEpsilon, 0.6),
      With(kCells, 0),
      [](Record& r) { r.mutable_question()->clear_values(); },
      [](Record& r) { r.mutable_question()->set_samples(0); },
      [](Record& r) { r.mutable_question()->set_samples(-7); },
      [](Record& r) { r.mutable_question()->set_collisions(9); },
      [](Record& r) { r.mutable_question()->set_estimate("conductivity"); },
      [](Record& r) { r.mutable_question()->set_tolerance(kNan); },
  });
}

TEST(LeaseRecord, ImpossibleChunksAreDataLoss) {
  using Record = storage::Lease;
  ExpectRefused({
      [](Record& r) { r.set_first_chunk(~uint64_t{0}); },
      [](Record& r) { r.set_first_chunk(r.end_chunk()); },
      [](Record& r) { r.set_end_chunk(0); },
      [](Record& r) { r.set_end_chunk(r.end_chunk() + 1); },
      [](Record& r) { r.set_blocks(~uint64_t{0}); },
      [](Record& r) { r.set_blocks(1); },
      [](Record& r) { r.mutable_partial()->set_samples(1); },
      [](Record& r) {
        r.set_blocks(1);
        r.mutable_partial()->set_samples(~uint64_t{0});
      },
      [](Record& r) { r.add_groups()->add_numbers(1); },
  });
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
