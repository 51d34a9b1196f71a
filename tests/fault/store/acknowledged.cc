#include "tests/fault/store/acknowledged.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/store/check_store.h"
#include "server/store/job_record.h"

namespace ballpiston::server {
namespace {

using v1::EnsembleJob;
using JobsBySeed = std::map<uint64_t, std::vector<EnsembleJob>>;

JobsBySeed BySeed(ServiceOnDisk& service) {
  JobsBySeed jobs;
  for (EnsembleJob& job : service.List()) jobs[job.spec().seed()].push_back(job);
  return jobs;
}

// Compares one life with what was acknowledged before it.
class Comparison {
 public:
  Comparison(const Trace& trace, size_t cut, ServiceOnDisk& service)
      : trace_(trace), cut_(cut), service_(service) {}

  std::vector<std::string> Run() {
    const JobsBySeed found = BySeed(service_);
    for (const auto& [seed, jobs] : found) {
      const auto traced = trace_.jobs.find(seed);
      if (traced == trace_.jobs.end() || !traced->second.create.WasMade(cut_)) {
        Say(seed, "was never asked for");
      }
    }
    for (const auto& [seed, traced] : trace_.jobs) {
      const auto here = found.find(seed);
      CompareJob(traced, here == found.end() ? std::vector<EnsembleJob>() : here->second);
    }
    for (const auto& [seed, traced] : trace_.jobs) Repeat(traced);
    return std::move(wrong_);
  }

 private:
  void Say(uint64_t seed, const std::string& what) {
    wrong_.push_back(absl::StrCat("job ", seed, " ", what));
  }

  void CompareJob(const TracedJob& traced, const std::vector<EnsembleJob>& found) {
    const uint64_t seed = traced.spec.seed();
    if (found.size() > 1) return Say(seed, absl::StrCat("exists ", found.size(), " times"));
    if (found.empty()) {
      const bool lost = traced.create.WasAnswered(cut_) && !traced.remove.WasMade(cut_);
      return lost ? Say(seed, "is lost") : void();
    }
    const EnsembleJob& job = found.front();
    if (traced.remove.WasAnswered(cut_)) return Say(seed, "was deleted and is back");
    if (traced.create.WasAnswered(cut_) && IdOf(job) != traced.id) Say(seed, "has another name");
    if (traced.success.WasAnswered(cut_)) {
      if (job.state() != EnsembleJob::SUCCEEDED) Say(seed, "had succeeded");
      if (service_.Results(IdOf(job)) != traced.results) Say(seed, "has lost its results");
    }
    CompareEnd(traced, service_.AwaitEnd(IdOf(job)));
  }

  void CompareEnd(const TracedJob& traced, const EnsembleJob& job) {
    const uint64_t seed = traced.spec.seed();
    const bool cancelled = job.state() == EnsembleJob::CANCELLED;
    if (traced.cancel.WasAnswered(cut_) && !cancelled) Say(seed, "was cancelled and went on");
    if (cancelled) {
      if (!traced.cancel.WasMade(cut_)) Say(seed, "is cancelled, which nobody asked for");
      return;
    }
    if (job.state() != EnsembleJob::SUCCEEDED) Say(seed, "did not succeed");
    if (service_.Results(IdOf(job)) != traced.results) Say(seed, "ended with other bytes");
  }

  // A client without an answer retries. A client with an answer may retry, too.
  void Repeat(const TracedJob& traced) {
    if (traced.request_id.empty() || traced.remove.WasMade(cut_)) return;
    const uint64_t seed = traced.spec.seed();
    const auto again = service_.Create(traced.spec, traced.request_id);
    if (!again.ok()) return Say(seed, absl::StrCat("asked for again: ", again.status().ToString()));
    if (traced.create.WasAnswered(cut_) && IdOf(*again) != traced.id) {
      Say(seed, "asked for again is another");
    }
    CompareEnd(traced, service_.AwaitEnd(IdOf(*again)));
    if (BySeed(service_)[seed].size() != 1) Say(seed, "asked for again exists twice");
  }

  const Trace& trace_;
  const size_t cut_;
  ServiceOnDisk& service_;
  std::vector<std::string> wrong_;
};

// Checks the store while the service runs, as an operator does.
void AddCheck(const FaultDisk& disk, std::vector<std::string>& wrong) {
  const auto summary = CheckStore(kStorePath, disk.vfs());
  if (!summary.ok()) return wrong.push_back(summary.status().ToString());
  for (const std::string& problem : summary->problems) wrong.push_back(problem);
}

}  // namespace

std::vector<std::string> WhatIsWrongAfter(const Trace& trace, size_t cut, Survival survival,
                                          uint64_t seed) {
  FaultDisk disk(AfterPowerCut(trace.initial, trace.operations, cut, survival, seed));
  ServiceOnDisk service(disk);
  if (!service.status().ok()) return {service.status().ToString()};
  std::vector<std::string> wrong;
  AddCheck(disk, wrong);
  for (std::string& sentence : Comparison(trace, cut, service).Run()) wrong.push_back(sentence);
  AddCheck(disk, wrong);
  return wrong;
}

}  // namespace ballpiston::server
