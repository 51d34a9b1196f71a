// What workers of a shared folder cost the server and the file system. Time, workers and folder are
// simulated; the scheduler and the executor of the folder are real. Nothing is stored.
//
//   folder_benchmark [virtual seconds]
//
// Each row has workers that compute equilibrium chunks of a minute or less, with a scatter of 20 %.
// No orbit is computed. The operations are those that a metadata server would see, of the server
// and the workers together. The processor time is that of the server's looks, with the scheduler.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <queue>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "server/cluster/folder_executor.h"
#include "server/host.h"
#include "server/processor_time.h"
#include "server/worker/lease_file.h"
#include "tests/server/compute/recording_journal.h"
#include "tests/server/compute/run_requests.h"
#include "tests/server/compute/stepped_executor.h"
#include "tests/server/factory_opener.h"
#include "tests/server/worker/fake_files.h"
#include "tests/simulation/machine.h"

namespace ballpiston::server {
namespace {

constexpr double kBetweenLooks = 1;
constexpr double kRetry = 10;  // seconds until a worker without a lease looks again

EnsembleSpec LongSpec() {
  EnsembleSpec spec = {.experiment = &kEquilibrium, .seed = 1, .model = Model::kBilliard};
  spec.grid = {{kRho, {0.53}}, {kDelta, {0.0125}}};
  spec.target.collisions = 1'000'000'000'000;
  return spec;
}

class Row {
 public:
  Row(Machine& machine, size_t workers) : machine_(machine) {
    scheduler_.Add(RunOf(1, LongSpec(), journal_));
    local_.TakeTurn();  // opens the point
    for (size_t i = 0; i < workers; ++i) At(10 * Scatter(), {i});
  }
  ~Row() { scheduler_.Shutdown(); }

  void Run(double seconds, size_t workers) {
    for (double second = 0; second < seconds; second += kBetweenLooks) {
      while (!events_.empty() && events_.top().time <= second) {
        Event event = events_.top();
        events_.pop();
        event.lease.empty() ? Take(event) : End(event);
      }
      machine_.Sleep(std::chrono::seconds(1));
      const double begin = ThreadSeconds();
      executor_.Look();
      const double cost = ThreadSeconds() - begin;
      if (second < seconds / 2) {  // until here the workers get their first leases
        before_ = files_.operations;
        ended_before_ = ended_;
        continue;
      }
      server_ += cost;
      longest_ = std::max(longest_, cost);
    }
    const double half = seconds / 2, leases = ended_ - ended_before_;
    const Pace pace = PaceOf(options_, workers);
    absl::PrintF("| %d | %.0f | %.0f | %.2f | %.1f | %.2f %% | %.2f | %.0f |\n", workers,
                 pace.lease, pace.timeout, leases / half, (files_.operations - before_) / half,
                 100 * server_ / half, 1e3 * server_ / std::max(leases, 1.0), 1e3 * longest_);
    std::fflush(stdout);
  }

 private:
  struct Event {
    size_t worker;
    std::string lease = {};
    double end = 0;  // of the lease
    double touch = 0;
    double time = 0;
    bool operator<(const Event& other) const { return time > other.time; }
  };

  double Scatter() {
    return 1 + 0.2 * (2 * static_cast<double>(machine_.Bits() >> 11) * 0x1p-53 - 1);
  }
  double Now() const { return std::chrono::duration<double>(machine_.now() - begin_).count(); }
  void At(double time, Event event) {
    event.time = time;
    events_.push(std::move(event));
  }
  std::string Name(const Event& event) const {
    return absl::StrCat(event.lease, ".w", event.worker);
  }

  void Take(Event event) {
    const auto names = *files_.List("todo");
    if (names.empty()) return At(Now() + kRetry * Scatter(), std::move(event));
    event.lease = names[machine_.Below(names.size())];
    if (!files_.Move("todo/" + event.lease, "taken/" + Name(event)).ok()) std::abort();
    const std::string bytes = *files_.Read("taken/" + Name(event), 0);
    absl::string_view rest = bytes;
    const LeaseFile file = *TakeLease(rest);
    event.end = Now() + SecondsOf(file.lease) * Scatter();
    event.touch = file.touch_seconds;
    At(std::min(event.end, Now() + event.touch), std::move(event));
  }

  void End(Event event) {
    const std::string taken = "taken/" + Name(event);
    if (event.time < event.end) {  // its chunks are appended at the end here, all at once
      files_.Touch(taken).IgnoreError();
      return At(std::min(event.end, event.time + event.touch), std::move(event));
    }
    absl::string_view bytes = files_.files.at(taken).bytes;
    const Lease lease = TakeLease(bytes)->lease;
    const LeaseReport report = {.chunks = Chunks(lease), .seconds = SecondsOf(lease)};
    files_.Append(taken, BytesOf(report)).IgnoreError();
    files_.Move(taken, absl::StrCat("done/", Name(event), ".finished")).IgnoreError();
    ++ended_;
    At(Now(), {event.worker});
  }

  static double SecondsOf(const Lease& lease) {
    const ChunkPlan& plan = lease.experiment->plan();
    const uint64_t begin = plan.BlockAt(lease.start.chunk, lease.start.blocks).first;
    return plan.SecondsFor(static_cast<double>(plan.SamplesBefore(lease.end) - begin));
  }

  // One result, with the number of samples that each chunk has.
  std::vector<ChunkResult> Chunks(const Lease& lease) {
    if (!block_) block_ = RunBlock(*lease.experiment, {.samples = 1});
    std::vector<ChunkResult> chunks;
    for (uint64_t chunk = lease.start.chunk; chunk < lease.end; ++chunk) {
      BlockResult result = *block_;
      result.samples = lease.experiment->plan().SamplesIn(chunk);
      for (Moments& moments : result.moments) moments.count = result.samples;
      chunks.push_back({chunk, std::move(result)});
    }
    return chunks;
  }

  Machine& machine_;
  const Machine::Clock::time_point begin_ = machine_.now();
  FakeFiles files_;
  FactoryOpener opener_{
      [](const EnsembleSpec& spec, size_t index) { return PointExperiment::Create(spec, index); }};
  const JournalPointer journal_ = std::make_shared<RecordingJournal>();
  Scheduler scheduler_{opener_, 1};
  SteppedExecutor local_{scheduler_};
  const ClusterOptions options_ = {.most_leases = 1'000'000};
  FolderExecutor executor_{scheduler_,
                           options_,
                           std::make_unique<FakeFiles>(files_),
                           {.identity = "me",
                            .flush = [] { return absl::OkStatus(); },
                            .prepare = [] { return absl::OkStatus(); }}};
  std::priority_queue<Event> events_;
  std::optional<BlockResult> block_;
  double ended_ = 0, ended_before_ = 0, before_ = 0, server_ = 0, longest_ = 0;
};

}  // namespace
}  // namespace ballpiston::server

int main(int argc, char** argv) {
  using namespace ballpiston::server;
  const double seconds = argc > 1 ? std::atof(argv[1]) : 7200;
  std::puts(
      "| workers | lease s | time-out s | leases/s | operations/s | server/core | ms a lease | "
      "longest look ms |\n|---|---|---|---|---|---|---|---|");
  for (const size_t workers : {10, 100, 600, 1000, 3000, 10'000}) {
    Machine machine(1);
    machine.Run([&] { Row(machine, workers).Run(seconds, workers); });
  }
  return 0;
}
