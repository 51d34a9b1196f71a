// The flights of a GPU (core/gpu) beside those of all threads of this machine. Needs a build with
// BALLPISTON_CUDA.
//
//   gpu_benchmark bits                many questions: the bits of both
//   gpu_benchmark speed DELTA HITS    first-hit with about so many wall hits: time and bits of both
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/ensemble/block_orbits.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/expected_returns.h"
#include "core/gpu/device_orbits.h"
#include "tests/core/one_point_spec.h"

namespace ballpiston {
namespace {

constexpr double kEpsilon0 = 0.125;

double Now() {
  const auto time = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(time).count();
}

unsigned AllThreads() { return std::max(std::thread::hardware_concurrency(), 1u); }

// ---- a point in several threads ----

struct SharedPoint {
  SharedPoint(const PointExperiment& experiment, const OrbitDevice* device)
      : point(experiment, device == nullptr
                              ? ChunkFold::kWindow
                              : ChunkFold::WindowFor(experiment.plan(), device->orbits())) {}
  std::mutex mutex;
  LocalPoint point;
};

class Queue : public BlockQueue {
 public:
  Queue(SharedPoint& shared, OrbitDevice* device) : shared_(shared), device_(device) {}
  std::optional<Block> Next() override {
    const std::lock_guard lock(shared_.mutex);
    return shared_.point.NextBlock();
  }
  void Done(const Block& block, BlockResult result) override {
    const std::lock_guard lock(shared_.mutex);
    shared_.point.Add(block, std::move(result));
  }
  bool Pause() override { return IsFinished(); }
  OrbitDevice* device() const override { return device_; }
  bool IsFinished() const {
    const std::lock_guard lock(shared_.mutex);
    return shared_.point.finished();
  }

 private:
  SharedPoint& shared_;
  OrbitDevice* device_;
};

struct Computed {
  BlockResult merged;
  double seconds;
};

Computed Compute(const PointExperiment& experiment, unsigned threads, OrbitDevice* device) {
  SharedPoint shared(experiment, device);
  const double begin = Now();
  std::vector<std::thread> running;
  for (unsigned i = 0; i < threads; ++i) {
    running.emplace_back([&] {
      Queue queue(shared, device);
      const std::unique_ptr<EngineRun> run = experiment.StartRun(queue);
      while (!queue.IsFinished()) {
        if (run->Advance()) std::this_thread::sleep_for(std::chrono::microseconds(200));
      }
    });
  }
  for (std::thread& thread : running) thread.join();
  return {shared.point.Merged(), Now() - begin};
}

std::unique_ptr<OrbitsOnDevice> Open(unsigned runs) {
  auto device = OpenCuda();
  if (!device.ok()) {
    std::printf("%s\n", std::string(device.status().message()).c_str());
    std::exit(1);
  }
  return std::make_unique<OrbitsOnDevice>(*std::move(device), runs, [](const absl::Status& status) {
    std::printf("  the device fails: %s\n", std::string(status.message()).c_str());
  });
}

EnsembleSpec Question(const ExperimentKind* experiment, double rho, double delta, double samples) {
  PointParameters point = {{kRho, rho}, {kDelta, delta}};
  if (experiment == &kFirstHit || experiment == &kConditionalMeanFreeTime) {
    point.Set(kEpsilon, kEpsilon0);
  }
  if (experiment == &kFirstHit) point.Set(kExponent, 1);
  const auto count = static_cast<int64_t>(samples);
  const Target target =
      experiment == &kEquilibrium ? Target{.collisions = count} : Target{.samples = count};
  return SpecOf(experiment, point, target, Model::kBilliard, 5);
}

// ---- questions ----

bool Compare(const char* name, const PointExperiment& experiment, const Computed& processor,
             const Computed& device) {
  const bool same = processor.merged == device.merged;
  const Estimate estimate = experiment.FirstEstimate(device.merged);
  std::printf("%-28s %s  samples %llu  %.9g  processor %.3g s, device %.3g s\n", name,
              same ? "same bits" : "OTHER BITS",
              static_cast<unsigned long long>(device.merged.samples), estimate.value,
              processor.seconds, device.seconds);
  std::fflush(stdout);
  return same;
}

bool ShowBits() {
  constexpr double kEvents = 2e9;
  const auto device = Open(AllThreads());
  bool same = true;
  for (const double rho : {0.501, kPaperRho, 0.7}) {
    for (const double share : {0.9, 0.3, 0.05}) {
      const double delta = share * PairDeltaBound(rho);
      for (const ExperimentKind* kind : {&kEquilibrium, &kConditionalMeanFreeTime, &kFirstHit,
                                         &kMarkovProperty, &kEnergyRelaxation}) {
        const auto some = PointExperiment::Create(Question(kind, rho, delta, 100), 0);
        const double samples = kEvents / some->plan().events_per_sample();
        const auto experiment = PointExperiment::Create(Question(kind, rho, delta, samples), 0);
        const Computed processor = Compute(*experiment, AllThreads(), nullptr);
        const Computed on_device = Compute(*experiment, AllThreads(), device.get());
        std::printf("rho %-8.4g delta %-8.3g ", rho, delta);
        same &= Compare(std::string(kind->name).c_str(), *experiment, processor, on_device);
      }
    }
  }
  return same;
}

bool ShowSpeed(double delta, double hits) {
  const PairGeometry geometry = PairGeometry::Create(kPaperRho, delta).value();
  const double hits_of_a_return = HitsPerReturn(geometry, kEpsilon0).ball_wall;
  const auto experiment =
      PointExperiment::Create(Question(&kFirstHit, kPaperRho, delta, hits / hits_of_a_return), 0);
  const Computed processor = Compute(*experiment, AllThreads(), nullptr);
  const double exact = *experiment->FirstEstimate(processor.merged).exact;
  const double flown = processor.merged.moments[0].mean *
                       static_cast<double>(processor.merged.samples) / exact * hits_of_a_return;
  std::printf("first-hit, delta %g: %.4g wall hits, %.4g a return\n", delta, flown,
              hits_of_a_return);
  std::printf("  processor, %2u threads: %.3g wall hits/s\n", AllThreads(),
              flown / processor.seconds);
  bool same = true;
  for (unsigned threads = 1; threads <= AllThreads(); threads *= 2) {
    const auto device = Open(threads);
    const Computed on_device = Compute(*experiment, threads, device.get());
    std::printf("  device,    %2u threads: %.3g wall hits/s, %.1f times the processor\n", threads,
                flown / on_device.seconds, processor.seconds / on_device.seconds);
    same &= Compare("", *experiment, processor, on_device);
  }
  return same;
}

bool Run(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const double delta = argc > 2 ? std::atof(argv[2]) : 0.0125;
  if (what == "bits") return ShowBits();
  if (what == "speed") return ShowSpeed(delta, argc > 3 ? std::atof(argv[3]) : 1e11);
  return true;
}

}  // namespace
}  // namespace ballpiston

int main(int argc, char** argv) { return ballpiston::Run(argc, argv) ? 0 : 1; }
