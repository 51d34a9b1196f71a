// Machines elsewhere that share a folder with the server. The server's part and the loop of the
// workers are the real ones; the folder is in memory. Workers are killed, crash, stop for minutes,
// are late or end early; operations of the folder fail, its clock jumps, it is emptied, and reports
// that the server has removed are there again.
#pragma once

#include "server/cluster/folder_executor.h"
#include "server/compute/scheduler.h"
#include "server/host.h"
#include "server/worker/worker.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/worker/fake_files.h"
#include "tests/simulation/expectations.h"
#include "tests/simulation/machine.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

inline constexpr std::chrono::milliseconds kLongestBlock(200);

// Toy experiments. Their blocks take time, and a block that crashes the engine (Question) calls
// `crash`.
inline ExperimentFactory ToyExperiments(Machine& machine, std::function<void()> crash) {
  return FakeExperimentsBySeed([&machine, crash = std::move(crash)](
                                   uint64_t seed, size_t, uint64_t block, const std::stop_token&) {
    machine.Sleep(machine.UpTo(kLongestBlock));
    const Question question = QuestionOf(seed);
    const bool is_last = block + 1 == static_cast<uint64_t>(question.blocks);
    if (question.crashes && is_last) crash();
  });
}

class SimulatedCluster {
 public:
  // The folder outlives the server. `flush` is that of the server's store.
  SimulatedCluster(Machine& machine, Scheduler& scheduler, FakeFiles& files,
                   std::function<absl::Status()> flush, bool engine_crashes)
      : machine_(machine),
        files_(files),
        engine_crashes_(engine_crashes),
        // A toy sample takes 0.02 s: a point has few leases.
        executor_(scheduler, {.lease = std::chrono::seconds(10), .least_waiting = 2},
                  std::make_unique<FakeFiles>(files),
                  {.identity = "me",
                   .flush = std::move(flush),
                   .prepare = [] { return absl::OkStatus(); },
                   .read_lease = [this](auto& bytes) { return ReadLease(bytes, [] {}); }}) {
    files_.before = [this](const std::string& operation, const std::string& path) {
      return BeforeOperation(operation, path);
    };
  }
  ~SimulatedCluster() {
    is_shutting_down_ = true;
    for (Thread& worker : workers_) worker.join();
    files_.before = nullptr;
    files_.files.merge(removed_reports_);  // the next life reads them
  }

  void Start() {
    executor_.Start();
    for (int i = 0; i < kWorkers; ++i) workers_.emplace_back([this] { Work(); });
  }

 private:
  static constexpr int kWorkers = 2;
  static constexpr std::chrono::seconds kLongestBreak{60};  // between two workers
  static constexpr std::chrono::minutes kLongestStop{5};    // of a worker that computes

  // The worker's machine loses its power.
  struct Killed {};

  absl::Status BeforeOperation(const std::string& operation, const std::string& path) {
    if (!is_shutting_down_ && machine_.Chance(0.002)) {
      return absl::UnavailableError("the folder does not answer");
    }
    const auto file = files_.files.find(path);
    const bool is_report = path.starts_with("done/") && file != files_.files.end();
    if (operation == "remove" && is_report && machine_.Chance(0.2)) removed_reports_.insert(*file);
    return absl::OkStatus();
  }

  void Work() {
    while (!is_shutting_down_) {
      machine_.Sleep(machine_.UpTo(kLongestBreak));
      if (machine_.Chance(0.2)) files_.now += absl::Hours(machine_.Below(20)) - absl::Hours(10);
      if (machine_.Chance(0.05)) files_.files.clear();
      if (machine_.Chance(0.5)) files_.files.merge(removed_reports_);
      try {
        WorkOnce();
      } catch (const Killed&) {
      }
    }
  }

  void WorkOnce() {
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
    server::Work(files_, {.name = absl::StrCat("worker", machine_.Bits())}, host)
        .IgnoreError();  // of the folder
  }

  EndOfWork EndOfWorker() {
    if (machine_.Chance(is_shutting_down_ ? 0.5 : 0.002)) throw Killed();
    if (is_shutting_down_) return EndOfWork::kNow;
    if (machine_.Chance(0.002)) machine_.Sleep(machine_.UpTo(kLongestStop));
    return machine_.Chance(0.002) ? EndOfWork::kAfterChunk : EndOfWork::kNotYet;
  }

  // Reads a lease and gives it a toy experiment.
  absl::StatusOr<LeaseFile> ReadLease(absl::string_view& bytes, std::function<void()> crash) const {
    absl::StatusOr<LeaseFile> file = TakeLease(bytes);
    if (!file.ok()) return file;
    Lease& lease = file->lease;
    EnsembleSpec spec = FakeSpec(static_cast<int>(lease.point) + 1, 1, lease.spec->seed);
    spec.target = lease.spec->target;
    lease.experiment = ToyExperiments(machine_, std::move(crash))(spec, lease.point);
    return file;
  }

  Machine& machine_;
  FakeFiles& files_;
  const bool engine_crashes_;
  std::remove_reference_t<decltype(FakeFiles::files)> removed_reports_;
  FolderExecutor executor_;
  bool is_shutting_down_ = false;
  std::vector<Thread> workers_;
};

}  // namespace ballpiston::server
