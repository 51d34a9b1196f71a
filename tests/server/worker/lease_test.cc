// A lease on its way to a worker and back: its file and its record.
#include "core/model_choice/ladder.h"
#include "server/convert/compressed.h"
#include "server/worker/lease_file.h"
#include "tests/server/worker/sample_leases.h"

namespace ballpiston::server {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

auto IsDataLoss() { return StatusIs(absl::StatusCode::kDataLoss); }

// ---- the file ----

TEST(LeaseFile, ANameHasTheLeaseTheWorkerAndTheOutcome) {
  const auto done = ParseDone("0123-7.node1-42-abcd.no-memory");
  ASSERT_TRUE(done);
  EXPECT_EQ(done->Done(*done->outcome), "done/0123-7.node1-42-abcd.no-memory");
  for (const char* other : {"", "a", ".a", "a.", "a.b.", "a.b.c", "a.b.c.finished", ".nfs0001"}) {
    EXPECT_FALSE(ParseDone(other)) << other;
  }
  for (const char* other : {"", "a", ".a", "a.", "a.b.finished"}) {
    EXPECT_FALSE(ParseTaken(other)) << other;
  }
}

TEST(LeaseFile, DamageIsDataLoss) {
  const Lease lease = LeaseOf(SpecOf(kFirstHit, Model::kBilliard));
  std::vector<std::string> leases = {Compressed("\xff\xff")}, reports = leases;
  for (const double seconds : {-1.0, std::numeric_limits<double>::infinity(), kNan}) {
    leases.push_back(FileOf(lease, seconds));
    reports.push_back(BytesOf(LeaseReport{.seconds = seconds}));
  }
  for (absl::string_view damaged : leases) EXPECT_THAT(TakeLease(damaged), IsDataLoss());
  for (absl::string_view damaged : reports) EXPECT_THAT(TakeReport(damaged), IsDataLoss());
}

// ---- the record ----
//
// worker_test.cc tests that merged blocks come back.

// The sizes of the plan, and the bits of the first samples. Chunks double until they have their
// largest size. A whole block of an open-ended target would take much longer.
auto PlanAndBits(const PointExperiment& experiment) {
  const ChunkPlan& plan = experiment.plan();
  const uint64_t last = plan.chunks() - 1;
  std::vector<uint64_t> sizes = {plan.samples(), last};
  for (const uint64_t chunk : {uint64_t{0}, std::min<uint64_t>(last, 1), last}) {
    sizes.push_back(plan.SamplesIn(chunk));
    sizes.push_back(plan.BlocksIn(chunk));
  }
  Block block = plan.BlockAt(0, 0);
  block.samples = std::min<uint64_t>(block.samples, 64);
  return std::pair(sizes, ChunkRecordBytes({0, RunBlock(experiment, block)}));
}

void ExpectComesBack(const Lease& lease) {
  const std::string bytes = FileOf(lease, 2.5);
  absl::string_view rest = bytes;
  ASSERT_OK_AND_ASSIGN(const LeaseFile file, TakeLease(rest));
  EXPECT_EQ(file.server, "a server");
  EXPECT_EQ(file.touch_seconds, 2.5);
  const Lease& back = file.lease;
  const auto numbers = [](const Lease& of) {
    return std::tuple(of.run, of.generation, of.point, of.start.chunk, of.start.blocks, of.end);
  };
  EXPECT_EQ(numbers(back), numbers(lease));
  EXPECT_EQ(back.groups, lease.groups);
  EXPECT_EQ(back.spec->seed, lease.spec->seed);
  EXPECT_EQ(back.spec->target.estimate, lease.spec->target.estimate);
  const PointExperiment &then = *lease.experiment, &now = *back.experiment;
  EXPECT_EQ(now.parameters(), then.parameters());
  EXPECT_EQ(now.answer().model, then.answer().model);
  EXPECT_EQ(now.expected_chunks(), then.expected_chunks());
  EXPECT_EQ(now.plan().events_per_sample(), then.plan().events_per_sample());
  EXPECT_EQ(PlanAndBits(now), PlanAndBits(then));
}

TEST(LeaseRecord, EveryQuestionKeepsItsPlanAndItsBits) {
  for (EnsembleSpec spec : EverySampledSpec()) {
    SCOPED_TRACE(absl::StrCat(spec.experiment->name, " by ", Name(spec.model)));
    ExpectComesBack(LeaseOf(spec));
    spec.target = {};
    ExpectComesBack(LeaseOf(spec));
    spec.target.tolerance = 0.1;
    if (AnswerViolations(spec).empty()) ExpectComesBack(LeaseOf(spec));
  }
  for (const char* question :
       {"equilibrium samples=2000 model=billiard precision=single",
        "energy-relaxation delta=1e-12 samples=2000 model=markov",  // outside the billiard's domain
        // By this estimate the worker judges a tolerance.
        "gas-equilibrium delta=0.19 samples=150 model=billiard estimate=conductivity"}) {
    SCOPED_TRACE(question);
    ExpectComesBack(LeaseOf(Asked(question)));
  }
  const EnsembleSpec grid =
      Asked("markov-property delta=0.1,0.07,0.03 samples=2000 model=billiard");
  Lease part = LeaseOf(grid, 1, 2);
  part.experiment = PointExperiment::Create(grid, 2);
  ExpectComesBack(part);
  Lease later = LeaseOf(SpecOf(kGasConduction, Model::kMarkov, 600));
  later.start.chunk = later.experiment->plan().groups();
  later.groups = FoldPoint(*later.experiment).groups;
  ExpectComesBack(later);
}

// AUTO may choose the jump process for a spec in single precision. The chunk plan depends on the
// precision, so the lease keeps it.
TEST(LeaseRecord, TheJumpProcessInSinglePrecisionComesBack) {
  EnsembleSpec spec = SpecOf(kEnergyRelaxation, Model::kAuto);
  spec.precision = Precision::kSingle;
  spec.verify = true;
  Lease lease = LeaseOf(spec);
  lease.experiment = PointExperiment::Create(spec, 0, {.model = Model::kMarkov});
  lease.end = lease.experiment->plan().chunks();
  ExpectComesBack(lease);
}

TEST(LeaseRecord, AnImpossibleQuestionIsDataLoss) {
  using Record = storage::Lease;
  const auto with_model = [](Model model) {
    return [model](Record& r) { r.mutable_question()->set_model(static_cast<uint32_t>(model)); };
  };
  const auto with = [](const Parameter& parameter, double value) {
    return [number = static_cast<uint32_t>(parameter.index), value](Record& r) {
      (*r.mutable_question()->mutable_values())[number] = value;
    };
  };
  const std::vector<std::function<void(Record&)>> harms = {
      [](Record& r) { r.clear_question(); },
      [](Record& r) { r.mutable_question()->set_experiment(999); },
      [](Record& r) { r.mutable_question()->set_model(77); },
      with_model(Model::kAuto),
      with_model(Model::kClosedForm),
      with_model(Model::kMarkov),
      [](Record& r) { (*r.mutable_question()->mutable_values())[kParameters.size()] = 1; },
      with(kRho, kNan),
      with(kDelta, -1),
      with(kDelta, 0.49),
      with(kEpsilon, 0.6),
      with(kCells, 0),
      [](Record& r) { r.mutable_question()->clear_values(); },
      [](Record& r) { r.mutable_question()->set_samples(0); },
      [](Record& r) { r.mutable_question()->set_samples(-7); },
      [](Record& r) { r.mutable_question()->set_collisions(9); },
      [](Record& r) { r.mutable_question()->set_estimate("conductivity"); },
      [](Record& r) { r.mutable_question()->set_tolerance(kNan); },
  };
  const Record good = LeaseRecord(LeaseOf(SpecOf(kFirstHit, Model::kBilliard)), "a server", 20);
  EXPECT_OK(LeaseOfRecord(good));
  for (size_t i = 0; i < harms.size(); ++i) {
    Record record = good;
    harms[i](record);
    EXPECT_THAT(LeaseOfRecord(record), IsDataLoss()) << i;
  }
}

}  // namespace
}  // namespace ballpiston::server
