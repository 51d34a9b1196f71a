// One life of a server without gRPC, over a disk that can fail: store, book of jobs and one worker
// with the fake experiments.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "server/book/job_book.h"
#include "server/store/store.h"
#include "tests/fault/store/fault_disk.h"
#include "tests/server/thread_pool.h"

namespace ballpiston::server {

inline constexpr char kStorePath[] = "/data/store.sqlite3";

// Lets blocks through one by one.
class Turnstile {
 public:
  void Pass(const std::stop_token& stop);
  // Lets `blocks` more blocks pass. Returns when they have passed and the next block waits.
  void Admit(int blocks);
  void AdmitAll();
  void AdmitNoMore();
  // Returns when a block waits.
  void AwaitWaiting();

 private:
  void AwaitWaiting(std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  int admitted_ = 0;
  bool all_ = false;
  int waiting_ = 0;
};

class ServiceOnDisk {
 public:
  // Without a turnstile nothing waits. Without a reserve the files have a few kB, so a test can
  // copy them at each cut.
  explicit ServiceOnDisk(FaultDisk& disk, Turnstile* turnstile = nullptr, size_t reserve_bytes = 0);
  ~ServiceOnDisk();  // stops like a server after SIGTERM

  // The status of opening the store and resuming its jobs. Call other functions only if it is OK.
  const absl::Status& status() const { return status_; }
  Store& store() { return *store_; }
  JobBook& book() { return *book_; }

  absl::StatusOr<v1::EnsembleJob> Create(const v1::EnsembleSpec& spec,
                                         const std::string& request_id);
  absl::StatusOr<v1::EnsembleJob> Cancel(const std::string& id, const std::string& request_id);
  absl::Status Delete(const std::string& id);
  absl::StatusOr<v1::EnsembleJob> Get(const std::string& id);
  std::vector<v1::EnsembleJob> List();

  // Waits for the end of the job and returns the job.
  v1::EnsembleJob AwaitEnd(const std::string& id);
  // All points, each serialized.
  std::vector<std::string> Results(const std::string& id);

  // Makes the log short, so that even a small trace writes it back and restarts it.
  void WriteLogBackOften();

 private:
  absl::Status status_;
  std::unique_ptr<Store> store_;
  std::unique_ptr<ThreadPool> pool_;
  std::unique_ptr<JobBook> book_;
};

// The job's id, a part of its name.
std::string IdOf(const v1::EnsembleJob& job);

}  // namespace ballpiston::server
