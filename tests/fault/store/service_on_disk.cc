#include "tests/fault/store/service_on_disk.h"

#include <chrono>
#include <limits>
#include <utility>

#include "server/convert/deterministic_bytes.h"
#include "server/convert/spec.h"
#include "server/store/job_record.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"
#include "tests/support/await.h"

namespace ballpiston::server {
namespace {

ExperimentFactory Factory(Turnstile* turnstile) {
  if (turnstile == nullptr) return FakeExperiments();
  return FakeExperiments(
      [turnstile](size_t, uint64_t, const std::stop_token& stop) { turnstile->Pass(stop); });
}

// Records wait until a request is committed, so that a trace does not depend on time.
Store::Options StoreOptions(const FaultDisk& disk, size_t reserve_bytes) {
  Store::Options options;
  options.delay = kNever;
  options.retry = std::chrono::milliseconds(1);
  options.stall = kNever;
  options.reserve_bytes = reserve_bytes;
  options.vfs = disk.vfs();
  return options;
}

}  // namespace

// ---- Turnstile ----

void Turnstile::Pass(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  ++waiting_;
  changed_.notify_all();
  changed_.wait(lock, stop, [this] { return all_ || admitted_ > 0; });
  --waiting_;
  if (admitted_ > 0) --admitted_;
  changed_.notify_all();
}

void Turnstile::Admit(int blocks) {
  std::unique_lock lock(mutex_);
  admitted_ += blocks;
  changed_.notify_all();
  AwaitWaiting(lock);
}

void Turnstile::AdmitAll() {
  std::lock_guard lock(mutex_);
  all_ = true;
  changed_.notify_all();
}

void Turnstile::AdmitNoMore() {
  std::lock_guard lock(mutex_);
  all_ = false;
}

void Turnstile::AwaitWaiting() {
  std::unique_lock lock(mutex_);
  AwaitWaiting(lock);
}

void Turnstile::AwaitWaiting(std::unique_lock<std::mutex>& lock) {
  AwaitNotified(changed_, lock, [this] { return admitted_ == 0 && waiting_ > 0; });
}

// ---- ServiceOnDisk ----

ServiceOnDisk::ServiceOnDisk(FaultDisk& disk, Turnstile* turnstile, size_t reserve_bytes) {
  auto store = Store::Open(kStorePath, StoreOptions(disk, reserve_bytes));
  status_ = store.status();
  if (!status_.ok()) return;
  store_ = *std::move(store);
  pool_ = std::make_unique<ThreadPool>(1, Factory(turnstile));
  book_ = std::make_unique<JobBook>(*store_, Limits(), pool_->scheduler());
  status_ = book_->Resume();
}

ServiceOnDisk::~ServiceOnDisk() {
  if (book_ != nullptr) book_->Shutdown();
  if (store_ != nullptr) store_->Close();
}

absl::StatusOr<v1::EnsembleJob> ServiceOnDisk::Create(const v1::EnsembleSpec& spec,
                                                      const std::string& request_id) {
  return book_->Create(LocalPrincipal(), CreateRequest(spec, request_id), CheckSpec(spec));
}

absl::StatusOr<v1::EnsembleJob> ServiceOnDisk::Cancel(const std::string& id,
                                                      const std::string& request_id) {
  return book_->Cancel(LocalPrincipal(), id, request_id);
}

absl::Status ServiceOnDisk::Delete(const std::string& id) {
  return book_->Delete(LocalPrincipal(), id);
}

absl::StatusOr<v1::EnsembleJob> ServiceOnDisk::Get(const std::string& id) {
  return book_->Get(LocalPrincipal(), id);
}

std::vector<v1::EnsembleJob> ServiceOnDisk::List() {
  const auto listed =
      book_->List(LocalPrincipal(), {.before = std::numeric_limits<int64_t>::max(),
                                     .max_jobs = 1000,
                                     .max_bytes = std::numeric_limits<size_t>::max()});
  return listed.ok() ? listed->jobs : std::vector<v1::EnsembleJob>();
}

v1::EnsembleJob ServiceOnDisk::AwaitEnd(const std::string& id) {
  absl::StatusOr<v1::EnsembleJob> job;
  AwaitThat([&] {
    job = Get(id);
    return absl::IsNotFound(job.status()) || (job.ok() && HasEnded(job->state()));
  });
  return job.value_or(v1::EnsembleJob());
}

std::vector<std::string> ServiceOnDisk::Results(const std::string& id) {
  std::vector<std::string> results;
  ResultsQuery query;
  query.max_points = 1000;
  query.max_bytes = std::numeric_limits<size_t>::max();
  const auto page = book_->Results(LocalPrincipal(), id, query);
  if (!page.ok()) return results;
  for (const v1::PointResult& point : page->points) results.push_back(DeterministicBytes(point));
  return results;
}

void ServiceOnDisk::WriteLogBackOften() {
  store_
      ->Commit([](Database& database) { return database.Execute("PRAGMA wal_autocheckpoint = 8"); })
      .IgnoreError();
}

std::string IdOf(const v1::EnsembleJob& job) { return job.name().substr(job.name().find('/') + 1); }

}  // namespace ballpiston::server
