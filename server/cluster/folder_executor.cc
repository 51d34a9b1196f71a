#include "server/cluster/folder_executor.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "core/ensemble/experiment_kind.h"
#include "server/status/failpoint.h"
#include "server/status/log.h"

namespace ballpiston::server {
namespace {

constexpr size_t kMostLeasesOfTheOptions = 600;
constexpr double kOperationsOfALease = 10;
constexpr double kOperationsASecond = 100;
constexpr std::chrono::seconds kBetweenPreparations(30);
constexpr std::chrono::seconds kLongestBackoff(60);
constexpr std::chrono::milliseconds kLongestEarlierPause(30'000);
constexpr std::chrono::seconds kSlowLook(30);
constexpr int kLooksForThreads = 2, kLooksForAWorker = 10;
constexpr size_t kMostLaidAtOnce = 300;
// A worker lists all waiting leases before it takes one.
constexpr size_t kMostWaiting = 300;
// A look lists all leases, so looks are rarer if there are many.
constexpr double kLeasesListedASecond = 500;

double SecondsOf(std::chrono::milliseconds time) {
  return std::chrono::duration<double>(time).count();
}

double SecondsBetween(std::chrono::steady_clock::time_point begin,
                      std::chrono::steady_clock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
}

// After an error there is no file, as far as the disk permits.
absl::StatusOr<FileStamp> WriteLease(SharedFiles& files, const LeaseFileName& file,
                                     const std::string& bytes) {
  const absl::StatusOr<FileStamp> stamp = files.Create(kLeaseBeingWritten, bytes);
  if (!stamp.ok()) return stamp;
  Failpoint("cluster.written");
  const absl::Status moved = files.Move(kLeaseBeingWritten, file.Todo());
  if (moved.ok()) return stamp;
  files.Remove(kLeaseBeingWritten).IgnoreError();
  return moved;
}

}  // namespace

Pace PaceOf(const ClusterOptions& options, size_t leases) {
  const double lease = SecondsOf(options.lease), timeout = SecondsOf(options.timeout);
  if (leases <= kMostLeasesOfTheOptions) return {lease, timeout / 6, timeout};
  const double longer =
      std::max(lease, static_cast<double>(leases) * kOperationsOfALease / kOperationsASecond);
  return {longer, 1.1 * longer, std::max(timeout, longer * 4 / 3)};
}

FolderExecutor::FolderExecutor(Scheduler& scheduler, const ClusterOptions& options,
                               std::unique_ptr<SharedFiles> files, Server server)
    : scheduler_(scheduler),
      options_(options),
      files_(std::move(files)),
      server_(std::move(server)),
      process_(absl::StrCat(absl::Hex(RandomBits(), absl::kZeroPad16))),
      capacity_{.local = false, .longest_chunk = options.longest_chunk} {}

void FolderExecutor::Start() {
  looking_ = std::make_unique<PeriodicThread>(options_.look, [this] { Look(); });
}

// Leases end by their time-out even if the folder cannot be used. An operation of the folder that
// hangs delays their ends until it returns.
void FolderExecutor::Look() {
  const Clock::time_point now = SteadyNow();
  if (now < next_look_) return;
  const double pause = static_cast<double>(leases_.size()) / kLeasesListedASecond - 1;
  next_look_ = now + std::chrono::milliseconds(static_cast<int64_t>(1e3 * std::max(pause, 0.0)));
  {
    MutexLock lock(mutex_);
    look_began_ = now;
  }
  absl::Status outcome;
  try {
    outcome = Prepare();
    if (outcome.ok()) outcome = Collect();
    if (!outcome.ok()) prepared_.reset();
    for (auto laid = leases_.begin(); laid != leases_.end();) LookAt(laid++);
    if (outcome.ok()) outcome = Lay();
  } catch (const std::exception& error) {
    outcome = absl::InternalError(error.what());
    prepared_.reset();
  }
  NoteOutcome(outcome);
}

absl::Status FolderExecutor::Prepare() {
  const Clock::time_point now = SteadyNow();
  if (prepared_ && now - *prepared_ < kBetweenPreparations) return absl::OkStatus();
  absl::Status prepared = server_.prepare();
  if (!prepared.ok()) return prepared;
  if (!prepared_) prepared = RemoveEarlier();
  if (prepared.ok()) prepared_ = now;
  return prepared;
}

// A worker ends if a lease is of another engine version, and this process lays the same chunks
// again.
absl::Status FolderExecutor::RemoveEarlier() {
  files_->Remove(kLeaseBeingWritten).IgnoreError();
  const auto waiting = files_->List("todo");
  if (!waiting.ok()) return waiting.status();
  for (const std::string& name : *waiting) {
    if (!leases_.contains(name)) files_->Remove(LeaseFileName{name}.Todo()).IgnoreError();
  }
  return absl::OkStatus();
}

void FolderExecutor::NoteOutcome(const absl::Status& outcome) {
  MutexLock lock(mutex_);
  look_began_.reset();
  status_.taken_leases = static_cast<double>(taken_);
  // While no worker takes leases, one lease at a time is laid. In the pause between two leases
  // there is still work, so Slurm's workers must stay.
  const bool lays_soon = outcome.ok() && !has_workers_ && SteadyNow() < next_laying_;
  status_.waiting_leases = static_cast<double>(leases_.size() - taken_ + (lays_soon ? 1 : 0));
  const std::string problem(outcome.message());
  if (std::exchange(status_.problem, problem) == problem) return;
  if (outcome.ok()) return LogInfo("cluster folder: works again");
  LogError(absl::StrCat("cluster folder: ", problem));
}

void FolderExecutor::Refuse(const absl::Status& why) {
  LogError(absl::StrCat("cluster folder: a file is refused: ", why.message()));
  MutexLock lock(mutex_);
  ++status_.refused_files;
}

// ---- files that workers have moved ----

// taken/ first: a file that is moved between the two listings is in both.
absl::Status FolderExecutor::Collect() {
  const auto taken = files_->List("taken");
  if (!taken.ok()) return taken.status();
  const auto done = files_->List("done");
  if (!done.ok()) return done.status();
  for (const std::string& name : *taken) {
    if (const auto file = ParseTaken(name)) NoteTaken(*file);
  }
  const std::vector<LeaseFileName> reported = ReportDone(*done);
  if (reported.empty()) return absl::OkStatus();
  Failpoint("cluster.file_reported");
  absl::Status flushed = server_.flush();
  if (!flushed.ok()) return flushed;  // the files are read again
  for (const LeaseFileName& file : reported) End(file);
  return absl::OkStatus();
}

// Returns the files that are reported. A file of an earlier process may have to wait until its
// point is open, so such files are read at growing intervals.
std::vector<LeaseFileName> FolderExecutor::ReportDone(const std::vector<std::string>& done) {
  const Clock::time_point now = SteadyNow();
  const bool earlier_are_due = now >= next_earlier_;
  bool earlier_stay = false;
  std::vector<LeaseFileName> reported;
  for (const std::string& name : done) {
    const auto file = ParseDone(name);
    const auto found = file ? leases_.find(file->lease) : leases_.end();
    const bool is_earlier = file && found == leases_.end();
    if (!file || (is_earlier && !earlier_are_due)) continue;
    // The lease may have been taken and have ended since the last look.
    if (!is_earlier) NoteWorker(found->second, file->worker);
    const bool stays = !Report(*file);
    if (!stays) reported.push_back(*file);
    earlier_stay |= is_earlier && stays;
  }
  if (!earlier_are_due) return reported;
  earlier_pause_ = std::min(std::max(2 * earlier_pause_, options_.look), kLongestEarlierPause);
  if (!earlier_stay) earlier_pause_ = std::chrono::milliseconds(0);
  next_earlier_ = now + earlier_pause_;
  return reported;
}

void FolderExecutor::NoteTaken(const LeaseFileName& file) {
  const auto found = leases_.find(file.lease);
  if (found == leases_.end()) {
    files_->Move(file.Taken(), file.Done(Outcome::kLost)).IgnoreError();  // it may be done now
    return;
  }
  NoteWorker(found->second, file.worker);
}

void FolderExecutor::NoteWorker(Laid& laid, const std::string& worker) {
  if (laid.worker == worker) return;
  const bool is_first = laid.worker.empty();
  laid.worker = worker;  // may throw
  taken_ += is_first;
  has_workers_ = true;
  laid.alive = laid.looked = claimed_ = SteadyNow();
  MutexLock lock(mutex_);
  ++status_.claims;
}

// False if the file has to stay: it cannot be read or reported now.
bool FolderExecutor::Report(const LeaseFileName& file) {
  if (file.outcome && reported_.contains(file.lease)) return true;
  const auto found = leases_.find(file.lease);
  Laid* const laid = found == leases_.end() ? nullptr : &found->second;
  const size_t offset = laid == nullptr ? 0 : laid->reported;
  const std::string path =
      laid != nullptr && !file.outcome ? file.Taken() : file.Done(*file.outcome);
  const absl::StatusOr<std::string> bytes = files_->Read(path, offset);
  if (absl::IsUnavailable(bytes.status()) || absl::IsNotFound(bytes.status())) return false;
  const absl::Status status = bytes.ok() ? ReportBytes(*bytes, laid) : bytes.status();
  if (absl::IsUnavailable(status)) return false;
  if (file.outcome) reported_.insert(file.lease);
  if (!status.ok() && (file.outcome || !absl::IsOutOfRange(status))) {
    Refuse(absl::Status(status.code(), absl::StrCat(path, ": ", status.message())));
  }
  return true;
}

// `laid` is null for the lease of an earlier process, which its file has in front.
absl::Status FolderExecutor::ReportBytes(absl::string_view bytes, Laid* laid) {
  const absl::StatusOr<Lease> lease = laid != nullptr ? laid->lease : TakeEarlier(bytes);
  absl::Status status = lease.status();
  while (status.ok() && !bytes.empty()) {
    const size_t left = bytes.size();
    status = ReportChunks(*lease, bytes);
    if (laid != nullptr) laid->reported += left - bytes.size();
  }
  return status;
}

// Takes the lease of an earlier process off the bytes of its file.
absl::StatusOr<Lease> FolderExecutor::TakeEarlier(absl::string_view& bytes) const {
  absl::StatusOr<LeaseFile> file = server_.read_lease(bytes);
  if (!file.ok()) return file.status();
  if (file->server != server_.identity) return absl::DataLossError("it is of another server");
  Lease lease = std::move(file->lease);
  lease.local = false;
  return lease;
}

// Reports one message, and takes it off the bytes unless it has to be reported later.
absl::Status FolderExecutor::ReportChunks(const Lease& lease, absl::string_view& bytes) {
  absl::string_view rest = bytes;
  absl::StatusOr<LeaseReport> report = TakeReport(rest);
  if (!report.ok()) return report.status();
  const bool has_others = std::ranges::any_of(report->chunks, [&](const ChunkResult& chunk) {
    return chunk.chunk < lease.start.chunk || chunk.chunk >= lease.end;
  });
  if (has_others) return absl::DataLossError("it has chunks of another lease");
  const auto chunks = static_cast<double>(report->chunks.size());
  const absl::Status reported = scheduler_.Report(lease, *std::move(report));
  if (absl::IsUnavailable(reported)) return reported;
  bytes = rest;
  MutexLock lock(mutex_);
  status_.chunks += chunks;
  return reported;
}

// Its chunks are on disk.
void FolderExecutor::End(const LeaseFileName& file) {
  const absl::Status removed = files_->Remove(file.Done(*file.outcome));
  if (!removed.ok() && !absl::IsNotFound(removed)) return;
  reported_.erase(file.lease);
  const auto found = leases_.find(file.lease);
  if (found == leases_.end()) return;
  const Lease& lease = found->second.lease;
  if (*file.outcome == Outcome::kCrashed) {
    LogError(absl::StrCat("cluster folder: the engine crashed in worker ", file.worker));
    scheduler_.ReturnCrashed(lease);
  }
  if (*file.outcome == Outcome::kNoMemory) {
    const double needed = MemoryOf(*lease.spec, lease.experiment->parameters(), 1);
    capacity_.memory = std::min(capacity_.memory, needed - 1);
    Log(Severity::kWarning,
        absl::StrCat("cluster folder: worker ", file.worker, " has less than ", needed,
                     " bytes of memory; this server's threads compute such points"));
  }
  if (*file.outcome == Outcome::kLost) {
    MutexLock lock(mutex_);
    ++status_.lost_leases;
  }
  GiveBack(found, *file.outcome != Outcome::kNoMemory);
}

// Chunks of the lease that did not arrive go out again. No effect if the lease was returned before.
void FolderExecutor::GiveBack(Leases::iterator laid, bool tried) {
  scheduler_.Return(laid->second.lease, tried);
  taken_ -= !laid->second.worker.empty();
  leases_.erase(laid);
}

// ---- files that stay where they are ----

void FolderExecutor::LookAt(Leases::iterator laid) {
  const LeaseFileName file = {laid->first, laid->second.worker};
  if (!scheduler_.Needs(laid->second.lease)) {
    files_->Remove(file.worker.empty() ? file.Todo() : file.Taken()).IgnoreError();
    return GiveBack(laid, true);
  }
  return file.worker.empty() ? LookAtWaiting(laid) : LookAtTaken(laid);
}

// A worker that takes the lease at this moment finds at its first touch that it has lost it.
void FolderExecutor::LookAtWaiting(Leases::iterator laid) {
  const Clock::time_point now = SteadyNow();
  const double timeout = laid->second.pace.timeout;
  const double probe = std::min(timeout, SecondsOf(kLooksForAWorker * options_.look));
  const double patience = has_workers_ ? timeout : probe;
  if (SecondsBetween(laid->second.alive, now) < patience) return;
  has_workers_ = taken_ > 0 || SecondsBetween(claimed_, now) < timeout;
  if (!has_workers_) next_laying_ = std::max(next_laying_, now + kLooksForThreads * options_.look);
  files_->Remove(LeaseFileName{laid->first}.Todo()).IgnoreError();
  GiveBack(laid, false);
}

void FolderExecutor::LookAtTaken(Leases::iterator laid) {
  Laid& lease = laid->second;
  const LeaseFileName file = {laid->first, lease.worker};
  const Clock::time_point now = SteadyNow();
  const bool is_late = SecondsBetween(lease.alive, now) >= lease.pace.timeout;
  const bool is_due = SecondsBetween(lease.looked, now) >= 1.1 * lease.pace.touch;
  if (!is_late && !is_due) return;
  lease.looked = now;
  const absl::StatusOr<FileStamp> stamp = files_->Stamp(file.Taken());
  if (stamp.ok() && std::exchange(lease.stamp, *stamp) != *stamp) {
    lease.alive = now;
    if (stamp->bytes > lease.reported) Report(file);
    return;
  }
  if (!is_late) return;
  // The lease's chunks are read from done/ at the next look. Its file may be gone.
  if (files_->Move(file.Taken(), file.Done(Outcome::kLost)).ok()) return;
  {
    MutexLock lock(mutex_);
    ++status_.lost_leases;
  }
  GiveBack(laid, true);
}

// ---- new leases ----

// After a failure, does nothing for `backoff_` but return the same failure. Then it tries again: if
// there is nothing to lay, it succeeds.
absl::Status FolderExecutor::Lay() {
  if (SteadyNow() < next_laying_) return laying_;
  laying_ = LaySome();
  if (!laying_.ok()) prepared_.reset();
  backoff_ = laying_.ok() ? std::chrono::seconds(0)
                          : std::clamp(2 * backoff_, std::chrono::seconds(1), kLongestBackoff);
  next_laying_ = SteadyNow() + backoff_;
  return laying_;
}

absl::Status FolderExecutor::LaySome() {
  for (size_t i = 0; i < kMostLaidAtOnce; ++i) {
    const size_t waiting = leases_.size() - taken_;
    const size_t wanted =
        has_workers_ ? std::max(options_.least_waiting, std::min(taken_, kMostWaiting)) : 1;
    const bool has_enough = waiting >= wanted;
    if (has_enough || leases_.size() >= options_.most_leases) break;
    capacity_.seconds = PaceOf(options_, leases_.size()).lease;
    std::optional<Lease> lease = scheduler_.Next(capacity_);
    if (!lease) break;
    absl::Status laid = LayOne(*lease);
    if (!laid.ok()) return laid;
  }
  return absl::OkStatus();
}

absl::Status FolderExecutor::LayOne(const Lease& lease) {
  absl::Cleanup give_back = [&] { scheduler_.Return(lease, false); };  // also after an exception
  const Pace pace = PaceOf(options_, leases_.size());
  const LeaseFileName file = {absl::StrCat(process_, "-", ++laid_)};
  const std::string bytes = BytesOf(LeaseRecord(lease, server_.identity, pace.touch));
  // The folder may have changed while there was no work.
  const absl::Status ready = leases_.empty() ? server_.prepare() : absl::OkStatus();
  const absl::StatusOr<FileStamp> stamp = ready.ok() ? WriteLease(*files_, file, bytes) : ready;
  if (!stamp.ok()) return stamp.status();
  Failpoint("cluster.laid");
  const Clock::time_point now = SteadyNow();
  leases_.emplace(file.lease, Laid{.lease = lease,
                                   .pace = pace,
                                   .alive = now,
                                   .looked = now,
                                   .stamp = *stamp,
                                   .reported = bytes.size()});
  std::move(give_back).Cancel();
  return absl::OkStatus();
}

FolderStatus FolderExecutor::Status(Clock::time_point now) const {
  MutexLock lock(mutex_);
  FolderStatus status = status_;
  if (look_began_ && now - *look_began_ > kSlowLook) {
    status.problem = absl::StrCat("the folder answers slowly or not at all: a look has taken ",
                                  SecondsBetween(*look_began_, now), " s so far");
  }
  return status;
}

}  // namespace ballpiston::server
