#include "tests/simulation/cluster.h"

#include "server/convert/compressed.h"
#include "server/convert/fold_record.h"
#include "server/worker/worker.h"
#include "tests/server/fake_experiments.h"
#include "tests/simulation/expectations.h"

namespace ballpiston::server {
namespace {

constexpr int kWorkers = 2;
constexpr std::chrono::seconds kLongestStart(60);
constexpr std::chrono::minutes kLongestStop(5);
constexpr std::chrono::milliseconds kLongestBlock(200);

// A toy sample takes 0.02 s.
const ClusterOptions kOptions = {.lease = std::chrono::seconds(10), .least_waiting = 2};

// The worker's machine loses its power.
struct Killed {};

// A spec that has the point, with the question's seed and target. Toy experiments need no more.
EnsembleSpec ToySpec(const storage::Question& question, size_t point) {
  EnsembleSpec spec = FakeSpec(static_cast<int>(point) + 1, 1, question.seed());
  spec.target = {.estimate = question.estimate()};
  if (question.has_samples()) spec.target.samples = question.samples();
  if (question.has_collisions()) spec.target.collisions = question.collisions();
  if (question.has_tolerance()) spec.target.tolerance = question.tolerance();
  return spec;
}

}  // namespace

ExperimentFactory ToyExperiments(Machine& machine, std::function<void()> crash) {
  return FakeExperimentsBySeed([&machine, crash = std::move(crash)](
                                   uint64_t seed, size_t, uint64_t block, const std::stop_token&) {
    machine.Sleep(machine.UpTo(kLongestBlock));
    const Question question = QuestionOf(seed);
    const bool is_last = block + 1 == static_cast<uint64_t>(question.blocks);
    if (question.crashes && is_last) crash();
  });
}

SimulatedCluster::SimulatedCluster(Machine& machine, Scheduler& scheduler, FakeFiles& files,
                                   std::function<absl::Status()> flush, bool engine_crashes)
    : machine_(machine),
      files_(files),
      engine_crashes_(engine_crashes),
      executor_(scheduler, kOptions, std::make_unique<FakeFiles>(files),
                {.identity = "me",
                 .flush = std::move(flush),
                 .prepare = [] { return absl::OkStatus(); },
                 .read_lease = [this](absl::string_view& bytes) { return ReadLease(bytes); }}) {
  files_.before = [this](const std::string& operation, const std::string& path) {
    return BeforeOperation(operation, path);
  };
}

SimulatedCluster::~SimulatedCluster() {
  is_shutting_down_ = true;
  for (Thread& worker : workers_) worker.join();
  files_.before = nullptr;
  files_.files.merge(removed_reports_);  // the next life reads them
}

absl::Status SimulatedCluster::BeforeOperation(const std::string& operation,
                                               const std::string& path) {
  if (!is_shutting_down_ && machine_.Chance(0.002)) {
    return absl::UnavailableError("the folder does not answer");
  }
  const auto file = files_.files.find(path);
  const bool is_report = path.starts_with("done/") && file != files_.files.end();
  if (operation == "remove" && is_report && machine_.Chance(0.2)) removed_reports_.insert(*file);
  return absl::OkStatus();
}

void SimulatedCluster::Start() {
  executor_.Start();
  for (int i = 0; i < kWorkers; ++i) workers_.emplace_back([this] { Work(); });
}

void SimulatedCluster::Work() {
  while (!is_shutting_down_) {
    machine_.Sleep(machine_.UpTo(kLongestStart));
    Trouble();
    try {
      WorkOnce();
    } catch (const Killed&) {
    }
  }
}

void SimulatedCluster::WorkOnce() {
  const WorkerOptions options = {.name = absl::StrCat("worker", machine_.Bits())};
  std::pair<std::string, std::string> move_at_a_crash;
  const auto crash = [&] {
    if (!engine_crashes_) return;
    files_.Move(move_at_a_crash.first, move_at_a_crash.second).IgnoreError();
    throw Killed();
  };
  const WorkerHost host = {
      .now = [this] { return machine_.now(); },
      .sleep =
          [this](std::chrono::duration<double> time) {
            machine_.Sleep(std::chrono::duration_cast<Machine::Clock::duration>(time));
          },
      .random_bits = [this] { return machine_.Bits(); },
      .processor_seconds = ProcessorSeconds,
      .end = [this] { return EndOfWorker(); },
      .report = [](absl::string_view) {},
      .lease_begins =
          [&](const std::string& from, const std::string& to) {
            move_at_a_crash = {from, to};
          },
      .read_lease = [&](absl::string_view& bytes) { return ReadLease(bytes, crash); }};
  server::Work(files_, options, host).IgnoreError();  // of the folder
}

EndOfWork SimulatedCluster::EndOfWorker() {
  if (machine_.Chance(is_shutting_down_ ? 0.5 : 0.002)) throw Killed();
  if (is_shutting_down_) return EndOfWork::kNow;
  if (machine_.Chance(0.002)) machine_.Sleep(machine_.UpTo(kLongestStop));
  return machine_.Chance(0.002) ? EndOfWork::kAfterChunk : EndOfWork::kNotYet;
}

void SimulatedCluster::Trouble() {
  if (machine_.Chance(0.2)) files_.now += absl::Hours(machine_.Below(20)) - absl::Hours(10);
  if (machine_.Chance(0.05)) files_.files.clear();
  if (machine_.Chance(0.5)) files_.files.merge(removed_reports_);
}

absl::StatusOr<LeaseFile> SimulatedCluster::ReadLease(absl::string_view& bytes,
                                                      std::function<void()> crash) const {
  const absl::StatusOr<std::string> plain = TakeCompressed(bytes, kMaxSharedFile);
  if (!plain.ok()) return plain.status();
  storage::Lease record;
  if (!record.ParseFromString(*plain)) return absl::DataLossError("not a lease");
  Lease lease = {.run = record.job(), .generation = record.generation()};
  lease.point = static_cast<size_t>(record.point());
  lease.spec = std::make_shared<const EnsembleSpec>(ToySpec(record.question(), lease.point));
  lease.experiment = ToyExperiments(machine_, std::move(crash))(*lease.spec, lease.point);
  lease.start = {record.first_chunk(), record.blocks(), ResultOfAccumulators(record.partial())};
  lease.end = record.end_chunk();
  return LeaseFile{record.server(), lease, record.touch_seconds()};
}

}  // namespace ballpiston::server
