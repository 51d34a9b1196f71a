// Computes leases on machines that share a folder with the server: it lays leases into the folder,
// and workers that somebody starts there take them (worker/worker.h).
//
// The folder is a means of transport and no store: it may be emptied at any time. The file of a
// lease proves the chunks in it (worker/lease_file.h). So a later process of the
// server reads the chunks that the workers of an earlier one left. The server looks every second:
//   - A file in todo/ that this process did not lay is removed at the first look.
//   - A lease in done/ ends. Its chunks are reported and on disk before its file is removed.
//   - A lease in taken/ of which the server knows nothing is moved to done/, so its worker stops.
//   - A lease that nobody takes goes back to the scheduler after the time-out. If no worker takes
//     any, the server waits two looks, so that its own threads can take the chunks first. Then it
//     lays one lease, which goes back after ten looks or the time-out, whichever is shorter. When a
//     worker takes one, others are laid again.
//   - A lease is lost if its file does not change, or is not there, for the time-out. The server
//     compares times of the folder only with each other, and measures the time-out with its own
//     steady clock. So a clock that jumps loses no lease.
// A late worker changes nothing, and a folder that is emptied loses no work (checked in
// tests/simulation).
// Thread-safe. One thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/compute/scheduler.h"
#include "server/host.h"
#include "server/mutex.h"
#include "server/periodic_thread.h"
#include "server/worker/lease_file.h"
#include "server/worker/shared_files.h"

namespace ballpiston::server {

struct ClusterOptions {
  std::string folder = {};
  std::string worker = {};                       // the program; empty: as installed
  std::chrono::milliseconds least_work{60'000};  // a run with less to compute stays here
  std::chrono::milliseconds timeout{120'000};    // after which a silent lease is lost
  std::chrono::milliseconds lease{180'000};      // of computing, about
  std::chrono::milliseconds look{1'000};         // between two looks
  // A longer chunk, in seconds, is computed here.
  double longest_chunk = std::numeric_limits<double>::infinity();
  size_t most_leases = 10'000;  // that workers have, and that wait for one
  size_t least_waiting = 16;    // leases that wait for a worker, if there is work
};

// How long leases are, and how often a worker touches the file of its own.
struct Pace {
  double lease, touch, timeout;  // seconds
};

// For so many leases at a time: a lease takes 10 metadata operations, and a touch and the look at
// it take 2. Up to 600 leases all the options hold. With more, leases are so long that all
// operations together are at most 100 a second, and a worker is late before it touches its file.
Pace PaceOf(const ClusterOptions& options, size_t leases);

// The work that is in the folder, at one moment.
struct FolderStatus {
  std::string problem = {};  // empty: none
  double waiting_leases = 0;
  double taken_leases = 0;
  // Since the start.
  double claims = 0;  // leases that workers took
  double chunks = 0;
  double lost_leases = 0;
  double refused_files = 0;
};

class FolderExecutor {
  using Clock = std::chrono::steady_clock;

 public:
  // The parts of the server that the executor uses.
  struct Server {
    std::string identity;                 // names it among all that may use the folder
    std::function<absl::Status()> flush;  // OK: all that was reported is on disk
    // Makes the folder ready; called before a look, and again every 30 s. The error is shown.
    std::function<absl::Status()> prepare;
    LeaseReader read_lease = TakeLease;
  };

  // The scheduler must outlive this. When this ends, workers go on.
  FolderExecutor(Scheduler& scheduler, const ClusterOptions& options,
                 std::unique_ptr<SharedFiles> files, Server server);

  // Begins to take leases. Call it once, after the runs of an earlier process were added.
  void Start();

  // What Start calls from its thread every second. Tests call it themselves.
  void Look();

  FolderStatus Status(Clock::time_point now = SteadyNow()) const;

 private:
  // A lease that is in the folder.
  struct Laid {
    Lease lease;
    Pace pace;
    Clock::time_point alive;   // when it was laid or taken, or when its file had changed
    Clock::time_point looked;  // at the file
    FileStamp stamp;           // then
    size_t reported = 0;       // bytes of the file
    std::string worker = {};   // empty: nobody has taken it
  };
  using Leases = std::map<std::string, Laid>;  // by name

  absl::Status Prepare();
  absl::Status RemoveEarlier();
  absl::Status Collect();
  std::vector<LeaseFileName> ReportDone(const std::vector<std::string>& done);
  void NoteTaken(const LeaseFileName& file);
  void NoteWorker(Laid& laid, const std::string& worker);
  bool Report(const LeaseFileName& file);
  absl::Status ReportBytes(absl::string_view bytes, Laid* laid);
  absl::StatusOr<Lease> TakeEarlier(absl::string_view& bytes) const;
  absl::Status ReportChunks(const Lease& lease, absl::string_view& bytes);
  void End(const LeaseFileName& file);
  void LookAt(Leases::iterator laid);
  void LookAtWaiting(Leases::iterator laid);
  void LookAtTaken(Leases::iterator laid);
  void GiveBack(Leases::iterator laid, bool tried);
  absl::Status Lay();
  absl::Status LaySome();
  absl::Status LayOne(const Lease& lease);
  void NoteOutcome(const absl::Status& outcome);
  void Refuse(const absl::Status& why);

  Scheduler& scheduler_;
  const ClusterOptions options_;
  const std::unique_ptr<SharedFiles> files_;
  const Server server_;
  const std::string process_;  // begins the names of this process's leases
  Capacity capacity_;

  // Used only by the thread that looks.
  Leases leases_;
  size_t taken_ = 0;                // of these
  Clock::time_point claimed_ = {};  // when a worker took the last one
  bool has_workers_ = true;         // false: none is taken, and none was within the time-out
  std::set<std::string> reported_;  // leases whose files in done/ are reported, but not removed yet
  uint64_t laid_ = 0;
  std::optional<Clock::time_point> prepared_;
  Clock::time_point next_look_ = {};
  Clock::time_point next_earlier_ = {};  // look at the files of earlier processes in done/
  std::chrono::milliseconds earlier_pause_{0};
  Clock::time_point next_laying_ = {};
  std::chrono::seconds backoff_{0};
  absl::Status laying_;  // the outcome of the last attempt to lay leases

  mutable Mutex mutex_;
  FolderStatus status_ ABSL_GUARDED_BY(mutex_);
  std::optional<Clock::time_point> look_began_ ABSL_GUARDED_BY(mutex_);  // one that goes on
  std::unique_ptr<PeriodicThread> looking_;  // last: its thread uses all members above
};

}  // namespace ballpiston::server
