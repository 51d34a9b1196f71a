// What a simulated cluster costs the server. The cluster is simulated in virtual time; scheduler,
// book of jobs, journal and store are real, and the store is a file in the temporary folder.
//
//   scheduler_benchmark [chunks] [points]
//
// The first table: chunks from one executor elsewhere, as fast as the server accepts them. The
// second: a sweep of first-hit jobs on clusters of two sizes. No orbit is computed: every chunk is
// one valid result with the number of samples that the chunk has. Each row runs in a process of its
// own, so that its peak memory is its own. The tables of docs/cluster.md are from here.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <optional>
#include <queue>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "server/book/job_book.h"
#include "server/compute/scheduler.h"
#include "server/convert/spec.h"
#include "server/processor_time.h"
#include "server/store/store.h"
#include "tests/server/factory_opener.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

constexpr double kLeaseSeconds = 60;  // of an executor elsewhere: about a minute a task

void ExitUnless(const absl::Status& ok) {
  if (ok.ok()) return;
  std::fprintf(stderr, "%s\n", ok.ToString().c_str());
  std::_Exit(1);
}

// ---- what a row costs ----

double ProcessSeconds(const rusage& used) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

rusage UsedByProcess() {
  rusage used = {};
  getrusage(RUSAGE_SELF, &used);
  return used;
}

double PeakMegabytes() { return static_cast<double>(UsedByProcess().ru_maxrss) / 1024; }

// The server's processor time: that of its calls in this thread, and of all other threads.
class Meter {
 public:
  template <typename Call>
  auto Measure(const Call& call) {
    const double begin = ThreadSeconds();
    auto result = call();
    calls_ += ThreadSeconds() - begin;
    return result;
  }

  double ServerSeconds() const {
    return calls_ + ProcessSeconds(UsedByProcess()) - process_begin_ -
           (ThreadSeconds() - thread_begin_);
  }
  double WallSeconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  const double process_begin_ = ProcessSeconds(UsedByProcess());
  const double thread_begin_ = ThreadSeconds();
  double calls_ = 0;
};

// ---- the server ----

// Takes part only as far as its caller has it take part. A lease is one turn.
class SimulatedExecutor : public Executor {
 public:
  SimulatedExecutor(Scheduler& scheduler, bool local, double seconds)
      : capacity_{.executor = scheduler.AddExecutor(*this), .local = local, .seconds = seconds} {}

  void Wake() override { is_woken_ = true; }
  void Shutdown() override {}

  const Capacity& capacity() const { return capacity_; }
  bool is_woken() const { return is_woken_; }
  void set_woken(bool woken) { is_woken_ = woken; }

 private:
  const Capacity capacity_;
  std::atomic<bool> is_woken_ = true;
};

class Server {
 public:
  explicit Server(double lease_seconds)
      : store_(*Store::Open(folder_.File("store"), {})),
        scheduler_(opener_, kLocalCores),
        local_(scheduler_, true, kLocalLeaseSeconds),
        remote_(scheduler_, false, lease_seconds),
        book_(*store_, Limits{.max_samples_per_job = 0}, scheduler_) {}

  static constexpr int kLocalCores = 2;
  static constexpr double kLocalLeaseSeconds = 5;

  void Create(const v1::EnsembleSpec& spec) {
    v1::CreateEnsembleJobRequest request;
    *request.mutable_spec() = spec;
    const CheckedSpec checked = CheckSpec(request.spec());
    ExitUnless(book_.Create({"ann", Role::kSubmit}, request, checked).status());
  }

  Store& store() { return *store_; }
  Scheduler& scheduler() { return scheduler_; }
  SimulatedExecutor& local() { return local_; }
  SimulatedExecutor& remote() { return remote_; }
  size_t active_jobs() const { return book_.active_jobs(); }

 private:
  TemporaryFolder folder_;
  std::unique_ptr<Store> store_;
  FactoryOpener opener_{
      [](const EnsembleSpec& spec, size_t index) { return PointExperiment::Create(spec, index); }};
  Scheduler scheduler_;
  SimulatedExecutor local_;
  SimulatedExecutor remote_;
  JobBook book_;
};

// Chunks of one result, which differ in the number of samples.
class FakeChunks {
 public:
  std::vector<ChunkResult> Of(const Lease& lease) {
    const ChunkPlan& plan = lease.experiment->plan();
    if (!block_) block_ = RunBlock(*lease.experiment, {.samples = 1});
    std::vector<ChunkResult> chunks;
    for (uint64_t chunk = lease.start.chunk; chunk < lease.end; ++chunk) {
      BlockResult result = *block_;
      result.samples = plan.SamplesIn(chunk);
      for (Moments& moments : result.moments) moments.count = result.samples;
      for (Histogram& histogram : result.histograms) Fill(histogram, result.samples);
      chunks.push_back({chunk, std::move(result)});
    }
    return chunks;
  }

 private:
  // Counts of a large chunk take more bytes in a record than counts of a small one.
  static void Fill(Histogram& histogram, uint64_t samples) {
    const uint64_t each = samples / (2 * histogram.counts.size());
    std::fill(histogram.counts.begin(), histogram.counts.end(), each);
  }

  std::optional<BlockResult> block_;
};

v1::EnsembleSpec SpecOf(const ExperimentKind& kind, double delta, int64_t samples, int points) {
  v1::EnsembleSpec spec;
  spec.set_experiment(static_cast<v1::EnsembleSpec::Experiment>(kind.number));
  spec.mutable_grid()->add_rho(0.53);
  spec.mutable_grid()->add_delta(delta);
  spec.set_model(v1::EnsembleSpec::BILLIARD);
  if (&kind == &kEquilibrium) {
    spec.mutable_target()->set_collisions(samples);
  } else {
    spec.mutable_target()->set_samples(samples);
    // One energy, so that all points have histograms of the same bins.
    spec.mutable_grid()->add_epsilon(0.1);
    for (int i = 0; i < points; ++i) spec.mutable_grid()->add_exponent(2 + 1.0 * i / points);
  }
  return spec;
}

// ---- chunks as fast as possible ----

void OpenOnePoint(Server& server) {
  const auto lease = server.scheduler().Next(server.local().capacity());
  for (const size_t point : lease->opens) server.scheduler().Open(*lease, point);
  server.scheduler().EndTurn(*lease, 0);
}

void AcceptChunks(const ExperimentKind& kind, bool in_order, size_t chunks) {
  Server server(0);  // a lease is one chunk
  server.Create(SpecOf(kind, 0.0125, kMaxSamples, 1));
  OpenOnePoint(server);
  std::vector<Lease> leases;
  while (leases.size() < chunks) {
    std::optional<Lease> lease = server.scheduler().Next(server.remote().capacity());
    if (!lease) break;
    leases.push_back(*std::move(lease));
  }
  std::mt19937_64 random(1);
  if (!in_order) std::shuffle(leases.begin(), leases.end(), random);
  FakeChunks computed;
  Meter meter;
  for (const Lease& lease : leases) {
    std::vector<ChunkResult> results = computed.Of(lease);
    meter.Measure([&] {
      ExitUnless(server.scheduler().Report(lease, {.chunks = std::move(results)}));
      server.scheduler().Return(lease);
      return 0;
    });
  }
  server.store().Flush().IgnoreError();
  const auto n = static_cast<double>(leases.size());
  absl::PrintF("| %s | %s | %.0f | %.0f | %.0f |\n", std::string(kind.name),
               in_order ? "in order" : "random", n / meter.WallSeconds(),
               1e6 * meter.ServerSeconds() / n, PeakMegabytes());
  std::fflush(stdout);
  std::_Exit(0);  // the job is not finished
}

// ---- a sweep ----

class Sweep {
 public:
  Sweep(Server& server, size_t cores) : server_(server), idle_{cores, Server::kLocalCores} {}

  void Run() {
    while (server_.active_jobs() > 0) {
      const bool began = BeginLeases();
      if (events_.empty()) {
        if (!began) server_.store().Flush().IgnoreError();  // the job's end is on its way
        continue;
      }
      EndNext();
    }
  }

  void Print(double delta, int points) const {
    absl::PrintF("| %g | %d | %d | %.0f | %.0f | %.0f %% | %.1f | %.0f |\n", delta, points, cores_,
                 work_, now_, 100 * work_elsewhere_ / (now_ * double(cores_)),
                 meter_.ServerSeconds(), PeakMegabytes());
    std::fflush(stdout);
  }

 private:
  struct Event {
    double time = 0;
    bool local = false;
    bool lost = false;
    Lease lease;

    bool operator<(const Event& other) const { return time > other.time; }  // earliest on top
  };

  bool BeginLeases() {
    bool began = false;
    while (idle_[1] > 0 && BeginLocal()) began = true;
    while (idle_[0] > 0 && BeginElsewhere()) began = true;
    return began;
  }

  // Empty, and without a call, if the executor has found nothing and was not woken since.
  std::optional<Lease> Next(SimulatedExecutor& executor) {
    if (!executor.is_woken()) return std::nullopt;
    auto lease = meter_.Measure([&] { return server_.scheduler().Next(executor.capacity()); });
    if (!lease) executor.set_woken(false);
    return lease;
  }

  bool BeginLocal() {
    std::optional<Lease> lease = Next(server_.local());
    if (!lease) return false;
    if (lease->OpensPoints()) {
      meter_.Measure([&] {
        for (const size_t point : lease->opens) server_.scheduler().Open(*lease, point);
        return server_.scheduler().EndTurn(*lease, 0);
      });
      return true;
    }
    --idle_[1];
    Begin({.local = true, .lease = *std::move(lease)});
    return true;
  }

  bool BeginElsewhere() {
    std::optional<Lease> lease = Next(server_.remote());
    if (!lease) return false;
    --idle_[0];
    const bool lost = random_() % 100 == 0;
    Begin({.lost = lost, .lease = *std::move(lease)});
    return true;
  }

  void Begin(Event event) {
    const double jitter = 0.8 + 0.4 * static_cast<double>(random_() >> 11) * 0x1p-53;
    event.time = now_ + event.lease.seconds * jitter;
    work_ += event.lease.seconds * jitter;
    if (!event.local) work_elsewhere_ += event.lease.seconds * jitter;
    events_.push(std::move(event));
  }

  void EndNext() {
    const Event event = events_.top();
    events_.pop();
    now_ = event.time;
    ++idle_[event.local ? 1 : 0];
    const Lease& lease = event.lease;
    std::vector<ChunkResult> chunks;
    if (!event.lost) chunks = computed_.Of(lease);
    meter_.Measure([&] {
      Scheduler& scheduler = server_.scheduler();
      if (!chunks.empty()) {
        ExitUnless(
            scheduler.Report(lease, {.chunks = std::move(chunks), .seconds = lease.seconds}));
      }
      if (event.local) {
        scheduler.EndTurn(lease, lease.seconds);
      } else {
        scheduler.Return(lease);
      }
      return 0;
    });
  }

  Server& server_;
  Meter meter_;
  FakeChunks computed_;
  std::mt19937_64 random_{1};
  size_t idle_[2];  // cores elsewhere and here
  const size_t cores_ = idle_[0];
  std::priority_queue<Event> events_;
  double now_ = 0;  // virtual
  double work_ = 0, work_elsewhere_ = 0;
};

void SweepOrbits(double delta, int points, size_t cores) {
  Server server(kLeaseSeconds);
  server.Create(SpecOf(kFirstHit, delta, 1'000'000'000, points));
  Sweep sweep(server, cores);
  sweep.Run();
  sweep.Print(delta, points);
}

// ---- processes ----

void InOwnProcess(const std::function<void()>& row) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    row();
    std::_Exit(0);
  }
  waitpid(child, nullptr, 0);
}

void PrintTables(size_t chunks, int points) {
  std::puts(
      "| experiment | order | chunks/s | server us/chunk | peak MB |\n"
      "|---|---|---|---|---|");
  for (const ExperimentKind* kind : {&kEquilibrium, &kFirstHit}) {
    for (const bool in_order : {true, false}) {
      InOwnProcess([&] { AcceptChunks(*kind, in_order, chunks); });
    }
  }
  std::puts(
      "\n| delta | points of 1e9 orbits | cores | work, core s | virtual s | cores busy | "
      "server's processor s | peak MB |\n|---|---|---|---|---|---|---|---|");
  for (const double delta : {0.1, 0.0125}) {
    for (const int size : {1, points}) {
      for (const size_t cores : {size_t{1'000}, size_t{100'000}}) {
        InOwnProcess([&] { SweepOrbits(delta, size, cores); });
      }
    }
  }
}

}  // namespace
}  // namespace ballpiston::server

int main(int argc, char** argv) {
  const size_t chunks = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 5000;
  const int points = argc > 2 ? std::atoi(argv[2]) : 1000;
  ballpiston::server::PrintTables(chunks, points);
}
