#include "tests/simulation/cluster.h"

#include <chrono>
#include <utility>

#include "tests/server/compute/remote_executor.h"

namespace ballpiston::server {
namespace {

constexpr int kMachines = 2;
constexpr double kSecondsOfALease = 10;  // a toy sample takes 0.02 s
constexpr std::chrono::seconds kLongestLook(20);
constexpr std::chrono::seconds kLongestReport(30);
constexpr std::chrono::minutes kLostAfter(5);

}  // namespace

Cluster::Cluster(Machine& machine, Scheduler& scheduler)
    : machine_(machine), scheduler_(scheduler), number_(scheduler.AddExecutor(*this)) {}

Cluster::~Cluster() {
  Shutdown();
  scheduler_.RemoveExecutor(number_);
}

void Cluster::Start() {
  for (int i = 0; i < kMachines; ++i) threads_.emplace_back([this] { Work(); });
}

void Cluster::Shutdown() {
  is_shutting_down_ = true;
  for (Thread& thread : std::exchange(threads_, {})) thread.join();
}

void Cluster::Work() {
  while (!is_shutting_down_) {
    machine_.Sleep(machine_.UpTo(kLongestLook));
    if (is_shutting_down_) return;
    const std::optional<Lease> lease =
        scheduler_.Next({.executor = number_, .seconds = kSecondsOfALease});
    if (lease) Compute(*lease);
  }
}

void Cluster::Compute(const Lease& lease) {
  std::vector<ChunkResult> chunks = ComputedChunks(lease);
  const bool is_lost = machine_.Chance(0.2), is_partial = machine_.Chance(0.3);
  if (is_partial) chunks.resize(machine_.Below(chunks.size() + 1));
  if (!is_lost) ReportInAnyOrder(lease, std::move(chunks));
  const auto until = machine_.now() + kLostAfter;
  while (!is_shutting_down_ && scheduler_.Needs(lease) && machine_.now() < until) {
    machine_.Sleep(kLongestLook);
  }
  if (!is_shutting_down_) scheduler_.Return(lease);
}

void Cluster::ReportInAnyOrder(const Lease& lease, std::vector<ChunkResult> chunks) {
  while (!chunks.empty()) {
    machine_.Sleep(machine_.UpTo(kLongestReport));
    if (is_shutting_down_) return;
    const size_t i = machine_.Below(chunks.size());
    scheduler_.Report(lease, {.chunks = {chunks[i]}, .seconds = 1}).IgnoreError();
    if (machine_.Chance(0.8)) chunks.erase(chunks.begin() + static_cast<ptrdiff_t>(i));
  }
}

}  // namespace ballpiston::server
