#include "tests/simulation/cluster.h"

#include "server/convert/compressed.h"
#include "server/convert/fold_record.h"
#include "server/worker/worker.h"
#include "tests/server/fake_experiments.h"

namespace ballpiston::server {
namespace {

constexpr int kWorkers = 2;
constexpr std::chrono::seconds kLongestStart(60);
constexpr std::chrono::minutes kLongestStop(5);

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

SimulatedCluster::SimulatedCluster(Machine& machine, Scheduler& scheduler, FakeFiles& files,
                                   ExperimentFactory experiments,
                                   std::function<absl::Status()> flush)
    : machine_(machine),
      files_(files),
      experiments_(std::move(experiments)),
      executor_(scheduler, kOptions, std::make_unique<FakeFiles>(files),
                {.identity = "me",
                 .flush = std::move(flush),
                 .prepare = [] { return absl::OkStatus(); },
                 .read_lease = [this](absl::string_view& bytes) { return ReadLease(bytes); }}) {
  files_.before = [this](const char*, const std::string&) {
    const bool fails = !is_shutting_down_ && machine_.Chance(0.002);
    return fails ? absl::UnavailableError("the folder does not answer") : absl::OkStatus();
  };
}

SimulatedCluster::~SimulatedCluster() {
  is_shutting_down_ = true;
  for (Thread& worker : workers_) worker.join();
  files_.before = nullptr;
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
      .lease_begins = [](const std::string&, const std::string&) {},
      .read_lease = [this](absl::string_view& bytes) { return ReadLease(bytes); }};
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
}

absl::StatusOr<LeaseFile> SimulatedCluster::ReadLease(absl::string_view& bytes) const {
  const absl::StatusOr<std::string> plain = TakeCompressed(bytes, kMaxSharedFile);
  if (!plain.ok()) return plain.status();
  storage::Lease record;
  if (!record.ParseFromString(*plain)) return absl::DataLossError("not a lease");
  Lease lease = {.run = record.job(), .generation = record.generation()};
  lease.point = static_cast<size_t>(record.point());
  lease.spec = std::make_shared<const EnsembleSpec>(ToySpec(record.question(), lease.point));
  lease.experiment = experiments_(*lease.spec, lease.point);
  lease.start = {record.first_chunk(), record.blocks(), ResultOfAccumulators(record.partial())};
  lease.end = record.end_chunk();
  return LeaseFile{record.server(), lease, record.touch_seconds()};
}

}  // namespace ballpiston::server
