// What a simulated cluster costs the server. The cluster is simulated in virtual time; scheduler,
// book of jobs, journal and store are real, and the store is a file in the temporary folder. No
// orbit is computed: every chunk is one valid result with the number of samples that the chunk has.
// The tables of docs/cluster.md are from here.
//
//   scheduler_benchmark [FLAG_OF_GOOGLE_BENCHMARK...]
//
// The column CPU is the server's processor time, of all its threads. A row computes once.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <queue>

#include "core/ensemble/point_fold.h"
#include "core/experiment/all_experiments.h"
#include "server/book/job_book.h"
#include "server/compute/scheduler.h"
#include "server/convert/spec.h"
#include "server/store/store.h"
#include "tests/server/factory_opener.h"
#include "tests/support/process.h"

namespace ballpiston::server {
namespace {

constexpr int kLocalCores = 2;
constexpr double kLocalLeaseSeconds = 5;
constexpr double kLeaseSeconds = 60;  // of an executor elsewhere: about a minute a task

void ExitUnless(const absl::Status& ok) {
  if (ok.ok()) return;
  std::cerr << ok << std::endl;
  std::_Exit(1);
}

// ---- the server ----

// A lease is one turn: no thread shares it.
struct OneTurn : SharedWork {
  bool HasTurn() const override { return false; }
};

struct Server {
  explicit Server(double lease_seconds) : remote{.local = false, .seconds = lease_seconds} {}

  // All points have the same energy, so their histograms have the same bins.
  void Create(const ExperimentKind& kind, double delta, int64_t samples, int points) {
    v1::CreateEnsembleJobRequest request;
    v1::EnsembleSpec& spec = *request.mutable_spec();
    spec.set_experiment(static_cast<v1::EnsembleSpec::Experiment>(kind.number));
    spec.mutable_grid()->add_rho(0.53);
    spec.mutable_grid()->add_delta(delta);
    spec.set_model(v1::EnsembleSpec::BILLIARD);
    if (&kind == &kEquilibrium) {
      spec.mutable_target()->set_collisions(samples);
    } else {
      spec.mutable_target()->set_samples(samples);
      spec.mutable_grid()->add_epsilon(0.1);
      for (int i = 0; i < points; ++i) spec.mutable_grid()->add_exponent(2 + 1.0 * i / points);
    }
    ExitUnless(book.Create({"ann", Role::kSubmit}, request, CheckSpec(spec)).status());
  }

  void Open(const Lease& lease) {
    for (const size_t point : lease.opens) scheduler.Open(lease, point);
    scheduler.EndTurn(lease, 0);
  }

  TemporaryFolder folder;
  std::unique_ptr<Store> store = *Store::Open(folder.File("store"), {});
  FactoryOpener opener{
      [](const EnsembleSpec& spec, size_t index) { return PointExperiment::Create(spec, index); }};
  Scheduler scheduler{opener, kLocalCores};
  Capacity local = {.local = true,
                    .share = [](const Lease&) { return std::make_shared<OneTurn>(); },
                    .seconds = kLocalLeaseSeconds};
  Capacity remote;
  JobBook book{*store, Limits{}, scheduler};
};

// Chunks of one result, which differ in the number of samples. Counts of a large chunk take more
// bytes in a record than counts of a small one.
std::vector<ChunkResult> ChunksOf(const Lease& lease, std::optional<BlockResult>& block) {
  if (!block) block = RunBlock(*lease.experiment, {.samples = 1});
  std::vector<ChunkResult> chunks;
  for (uint64_t chunk = lease.start.chunk; chunk < lease.end; ++chunk) {
    BlockResult result = *block;
    result.samples = lease.experiment->plan().SamplesIn(chunk);
    for (Moments& moments : result.moments) moments.count = result.samples;
    for (Histogram& histogram : result.histograms) {
      const uint64_t each = result.samples / (2 * histogram.counts.size());
      std::fill(histogram.counts.begin(), histogram.counts.end(), each);
    }
    chunks.push_back({chunk, std::move(result)});
  }
  return chunks;
}

// ---- chunks from one executor elsewhere, as fast as the server accepts them ----

void AcceptChunks(benchmark::State& state, const ExperimentKind& kind, bool in_order) {
  constexpr size_t kChunks = 5000;
  Server server(0);  // a lease is one chunk
  server.Create(kind, 0.0125, kMaxSamples, 1);
  server.Open(*server.scheduler.Next(server.local));
  std::vector<Lease> leases;
  while (leases.size() < kChunks) leases.push_back(server.scheduler.Next(server.remote).value());
  std::mt19937_64 random(1);
  if (!in_order) std::shuffle(leases.begin(), leases.end(), random);
  std::optional<BlockResult> block;
  std::vector<std::vector<ChunkResult>> results;
  for (const Lease& lease : leases) results.push_back(ChunksOf(lease, block));
  for (auto _ : state) {
    for (size_t i = 0; i < leases.size(); ++i) {
      ExitUnless(server.scheduler.Report(leases[i], {.chunks = std::move(results[i])}));
      server.scheduler.Return(leases[i]);
    }
    server.store->Flush().IgnoreError();
  }
  state.counters["chunks"] = benchmark::Counter(kChunks, benchmark::Counter::kIsRate);
}

// ---- a sweep on a cluster ----

class Sweep {
 public:
  Sweep(benchmark::State& state, Server& server, size_t cores)
      : state_(state), server_(server), cores_(cores), idle_elsewhere_(cores) {}

  void Run() {
    while (server_.book.active_jobs() > 0) {
      const bool began = BeginLeases();
      if (!events_.empty()) {
        EndNext();
      } else if (!began) {
        server_.store->Flush().IgnoreError();  // the job's end is on its way
      }
    }
    state_.counters["virtual_s"] = now_;
    state_.counters["work_s"] = work_;  // of all cores
    state_.counters["busy"] = work_elsewhere_ / (now_ * static_cast<double>(cores_));
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
    for (const bool local : {true, false}) {
      size_t& idle = local ? idle_here_ : idle_elsewhere_;
      while (idle > 0) {
        std::optional<Lease> lease = server_.scheduler.Next(local ? server_.local : server_.remote);
        if (!lease) break;
        began = true;
        if (lease->OpensPoints()) {
          server_.Open(*lease);
          continue;
        }
        --idle;
        const bool lost = !local && random_() % 100 == 0;
        Begin({.local = local, .lost = lost, .lease = *std::move(lease)});
      }
    }
    return began;
  }

  void Begin(Event event) {
    const double jitter = 0.8 + 0.4 * static_cast<double>(random_() >> 11) * 0x1p-53;
    const double work = event.lease.seconds * jitter;
    event.time = now_ + work;
    work_ += work;
    if (!event.local) work_elsewhere_ += work;
    events_.push(std::move(event));
  }

  void EndNext() {
    const Event event = events_.top();
    events_.pop();
    now_ = event.time;
    ++(event.local ? idle_here_ : idle_elsewhere_);
    const Lease& lease = event.lease;
    if (!event.lost) {
      state_.PauseTiming();
      LeaseReport report = {.chunks = ChunksOf(lease, block_), .seconds = lease.seconds};
      state_.ResumeTiming();
      ExitUnless(server_.scheduler.Report(lease, std::move(report)));
    }
    if (event.local) {
      server_.scheduler.EndTurn(lease, lease.seconds);
    } else {
      server_.scheduler.Return(lease);
    }
  }

  benchmark::State& state_;
  Server& server_;
  const size_t cores_;
  size_t idle_elsewhere_, idle_here_ = kLocalCores;
  std::optional<BlockResult> block_;
  std::mt19937_64 random_{1};
  std::priority_queue<Event> events_;
  double now_ = 0;  // virtual
  double work_ = 0, work_elsewhere_ = 0;
};

void SweepOrbits(benchmark::State& state, double delta, size_t cores) {
  constexpr int kPoints = 300;
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // forgets the largest memory so far
  for (auto _ : state) {
    Server server(kLeaseSeconds);
    server.Create(kFirstHit, delta, 1'000'000'000, kPoints);
    Sweep(state, server, cores).Run();
  }
  state.counters["peak_MB"] = MiBOf("self", "VmHWM:");
}

void AddRow(const std::string& name, const std::function<void(benchmark::State&)>& row) {
  benchmark::RegisterBenchmark(name.c_str(), row)
      ->MeasureProcessCPUTime()
      ->UseRealTime()
      ->Unit(benchmark::kSecond)
      ->Iterations(1)
      ->Repetitions(1);
}

void AddRows() {
  for (const ExperimentKind* kind : {&kEquilibrium, &kFirstHit}) {
    for (const bool in_order : {true, false}) {
      AddRow(absl::StrCat("accept/", kind->name, in_order ? "/in_order" : "/random"),
             [=](benchmark::State& state) { AcceptChunks(state, *kind, in_order); });
    }
  }
  for (const double delta : {0.1, 0.0125}) {
    for (const size_t cores : {size_t{1'000}, size_t{100'000}}) {
      AddRow(absl::StrCat("sweep/delta:", delta, "/points_of_1e9:300/cores:", cores),
             [=](benchmark::State& state) { SweepOrbits(state, delta, cores); });
    }
  }
}

}  // namespace
}  // namespace ballpiston::server

int main(int argc, char** argv) {
  ballpiston::server::AddRows();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
