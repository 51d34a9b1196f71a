// The disk rejects a write or a flush, once or from then on. A call either fails or succeeds, and
// its answer is true. Computed results are kept until the disk works again.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <future>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/spec.h"
#include "server/store/check_store.h"
#include "server/store/job_table.h"
#include "tests/fault/store/fault_disk.h"
#include "tests/fault/store/power_cut.h"
#include "tests/fault/store/service_on_disk.h"
#include "tests/server/error_details.h"
#include "tests/server/requests.h"
#include "tests/support/await.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::IsEmpty;
using Refusal = FaultDisk::Refusal;
using v1::EnsembleJob;

bool IsLong() { return std::getenv("BALLPISTON_TORTURE") != nullptr; }

constexpr Refusal kRefusals[] = {Refusal::kFull, Refusal::kWriteError, Refusal::kSyncError};

std::string NameOf(Refusal refusal) {
  const char* const names[] = {"full", "write error", "sync error"};
  return names[static_cast<size_t>(refusal)];
}

void ExpectDiskFailure(const absl::Status& status, Refusal refusal) {
  EXPECT_THAT(status, IsError(absl::StatusCode::kUnavailable,
                              refusal == Refusal::kFull ? "STORE_FULL" : "STORE_FAILED"));
}

// Flush succeeds only when all pending writes are written.
void AwaitWritten(Store& store) {
  AwaitThat([&] { return store.Flush().ok(); });
}

// A job that waits at a turnstile, a job that has ended, and the three calls that write.
class Scene {
 public:
  Scene() : service_(std::make_unique<ServiceOnDisk>(disk_, &turnstile_)) {
    EXPECT_OK(service_->status());
    ended_ = Make(1);
    turnstile_.AdmitAll();
    service_->AwaitEnd(ended_);
    turnstile_.AdmitNoMore();
    running_ = Make(2);
    turnstile_.AwaitWaiting();
    turnstile_.Admit(1);
    AwaitWritten(service_->store());
    service_->WriteLogBackOften();
  }

  FaultDisk& disk() { return disk_; }
  Turnstile& turnstile() { return turnstile_; }
  ServiceOnDisk& service() { return *service_; }
  const std::string& running() const { return running_; }

  absl::Status Create() { return service_->Create(Equilibrium(1, 2, 3), "request").status(); }
  absl::Status Cancel() { return service_->Cancel(running_, "cancel").status(); }
  absl::Status Delete() { return service_->Delete(ended_); }

  bool IsCreated() { return Count(*service_, 3) == 1; }
  bool IsCancelled() {
    const auto state = service_->Get(running_)->state();
    return state == EnsembleJob::CANCELLING || state == EnsembleJob::CANCELLED;
  }
  bool IsDeleted() { return Count(*service_, 1) == 0; }

  // The number of the service's jobs with this seed.
  static int Count(ServiceOnDisk& service, uint64_t seed) {
    int count = 0;
    for (const EnsembleJob& job : service.List()) count += job.spec().seed() == seed ? 1 : 0;
    return count;
  }

  // The files after a power cut at this moment.
  DiskFiles CutNow(Survival survival) const {
    const std::vector<DiskOperation> operations = disk_.operations();
    return AfterPowerCut({}, operations, operations.size(), survival, 1);
  }

 private:
  std::string Make(uint64_t seed) {
    const auto job = service_->Create(Equilibrium(1, 3, seed), "");
    EXPECT_OK(job);
    return job.ok() ? IdOf(*job) : "";
  }

  FaultDisk disk_;
  Turnstile turnstile_;
  std::unique_ptr<ServiceOnDisk> service_;
  std::string ended_;
  std::string running_;
};

struct Operation {
  const char* name;
  absl::Status (Scene::*call)();
  bool (Scene::*is_done)();
};

constexpr Operation kOperations[] = {{"create", &Scene::Create, &Scene::IsCreated},
                                     {"cancel", &Scene::Cancel, &Scene::IsCancelled},
                                     {"delete", &Scene::Delete, &Scene::IsDeleted}};

// One call on a disk that refuses its operation number `at` (and all later ones).
class Refused {
 public:
  Refused(const Operation& operation, Refusal refusal, size_t at, bool persistent)
      : operation_(operation), refusal_(refusal), first_(scene_.disk().operation_count() + at) {
    if (persistent) {
      scene_.disk().Refuse(refusal, first_);
    } else {
      scene_.disk().Refuse(refusal, first_, 1);
    }
    status_ = Call();
  }

  Scene& scene() { return scene_; }
  bool has_operation() { return scene_.disk().operation_count() > first_; }
  // Otherwise the operation is of another kind, or is not made.
  bool was_refused() { return has_operation() && scene_.disk().operations()[first_].refused; }
  absl::Status Call() { return (scene_.*operation_.call)(); }
  bool IsDone() { return (scene_.*operation_.is_done)(); }

  void ExpectNoFalseAnswer() {
    EXPECT_EQ(IsDone(), status_.ok()) << status_;
    if (!status_.ok()) ExpectDiskFailure(status_, refusal_);
    if (!status_.ok()) {
      EXPECT_GT(scene_.service().store().counts().failures, 0);
    }
  }

  // An acknowledged call survives a power cut. The outcome of a failed call is unknown, and its
  // retry does the work once.
  // The short form takes one survival of unsynced data for each refused operation, in turn.
  void ExpectItSurvives(size_t turn) {
    for (size_t i = 0; i < std::size(kSurvivals); ++i) {
      if (!IsLong() && i != turn % std::size(kSurvivals)) continue;
      const Survival survival = kSurvivals[i];
      FaultDisk left(scene_.CutNow(survival));
      ServiceOnDisk service(left);
      ASSERT_OK(service.status());
      const bool deletes = operation_.is_done == &Scene::IsDeleted;
      if (status_.ok() && deletes) {
        EXPECT_EQ(Scene::Count(service, 1), 0);
      }
      if (operation_.call != &Scene::Create) continue;
      if (status_.ok()) {
        EXPECT_EQ(Scene::Count(service, 3), 1);
      }
      EXPECT_OK(service.Create(Equilibrium(1, 2, 3), "request"));
      EXPECT_EQ(Scene::Count(service, 3), 1);
    }
  }

  // The disk works again: the retry succeeds, and all jobs go on.
  void ExpectItGoesOn() {
    scene_.disk().StopRefusing();
    const absl::Status again = Call();
    scene_.turnstile().AdmitAll();
    const bool done_before = absl::IsNotFound(again) && operation_.call == &Scene::Delete;
    EXPECT_TRUE(again.ok() || done_before) << again;
    EXPECT_TRUE(IsDone());
    AwaitWritten(scene_.service().store());
    EXPECT_FALSE(scene_.service().store().failing());
    const EnsembleJob end = scene_.service().AwaitEnd(scene_.running());
    const bool cancels = operation_.call == &Scene::Cancel;
    EXPECT_EQ(end.state(), cancels ? EnsembleJob::CANCELLED : EnsembleJob::SUCCEEDED);
    ASSERT_OK_AND_ASSIGN(const auto summary, CheckStore(kStorePath, scene_.disk().vfs()));
    EXPECT_THAT(summary.problems, IsEmpty());
  }

 private:
  Scene scene_;
  const Operation& operation_;
  const Refusal refusal_;
  const size_t first_;
  absl::Status status_;
};

// Calls `test` for every operation of the disk that a call makes.
void ForEachRefused(bool persistent, const std::function<void(Refused&, size_t turn)>& test) {
  size_t turn = 0;
  for (const Operation& operation : kOperations) {
    for (const Refusal refusal : kRefusals) {
      int refused = 0;
      for (size_t at = 0; at < 100; ++at) {
        SCOPED_TRACE(absl::StrCat(operation.name, ", ", NameOf(refusal), " at ", at));
        Refused attempt(operation, refusal, at, persistent);
        if (!attempt.has_operation()) break;
        if (!attempt.was_refused()) continue;  // another kind of operation
        ++refused;
        test(attempt, turn++);
      }
      EXPECT_GT(refused, 0) << operation.name << ", " << NameOf(refusal);
    }
  }
}

TEST(DiskFailure, ACallDuringOneDiskErrorFailsOrSucceeds) {
  ForEachRefused(false, [](Refused& attempt, size_t turn) {
    attempt.ExpectNoFalseAnswer();
    attempt.ExpectItSurvives(turn);
    attempt.ExpectItGoesOn();
  });
}

TEST(DiskFailure, ACallDuringALongDiskErrorFailsOrSucceeds) {
  ForEachRefused(true, [](Refused& attempt, size_t turn) {
    attempt.ExpectNoFalseAnswer();
    attempt.ExpectItSurvives(turn);
    attempt.ExpectItGoesOn();
  });
}

// The flush of the transaction failed, but its data is on the disk when the power is cut.
TEST(DiskFailure, ACreateInDoubtIsFoundByItsRequestId) {
  Scene scene;
  scene.disk().Refuse(Refusal::kSyncError, scene.disk().operation_count());
  ExpectDiskFailure(scene.Create(), Refusal::kSyncError);
  EXPECT_FALSE(scene.IsCreated());
  std::set<int> before;
  const std::vector<DiskOperation> operations = scene.disk().operations();
  const auto failed = std::find_if(operations.begin(), operations.end(),
                                   [](const DiskOperation& done) { return done.refused; });
  const auto cut = static_cast<size_t>(failed - operations.begin());  // before the retry
  for (const Survival survival : {Survival::kNothing, Survival::kEverything}) {
    FaultDisk left(AfterPowerCut({}, operations, cut, survival, 0));
    ServiceOnDisk service(left);
    before.insert(Scene::Count(service, 3));
    EXPECT_OK(service.Create(Equilibrium(1, 2, 3), "request"));
    EXPECT_EQ(Scene::Count(service, 3), 1);
  }
  EXPECT_THAT(before, testing::ElementsAre(0, 1));  // both outcomes are possible
}

TEST(DiskFailure, ResultsAreStoredWhenTheDiskWorksAgain) {
  for (const Refusal refusal : kRefusals) {
    Scene scene;
    scene.disk().Refuse(refusal, scene.disk().operation_count());
    scene.turnstile().AdmitAll();
    // The job's end has been tried and refused.
    while (!scene.service().store().failing()) scene.service().store().Flush().IgnoreError();
    EXPECT_EQ(scene.service().Get(scene.running())->state(), EnsembleJob::RUNNING);
    scene.disk().StopRefusing();
    EXPECT_EQ(scene.service().AwaitEnd(scene.running()).state(), EnsembleJob::SUCCEEDED);
    EXPECT_EQ(scene.service().Results(scene.running()).size(), 1u);
    const auto summary = CheckStore(kStorePath, scene.disk().vfs());
    EXPECT_TRUE(summary.ok() && summary->sound());
  }
}

TEST(DiskFailure, TheStoreNoticesByItselfThatTheDiskWorksAgain) {
  Scene scene;
  scene.disk().Refuse(Refusal::kWriteError, scene.disk().operation_count());
  EXPECT_FALSE(scene.Create().ok());
  EXPECT_TRUE(scene.service().store().failing());
  const int64_t refusals = scene.disk().refusals();
  AwaitThat([&] { return scene.disk().refusals() >= refusals + 3; });  // the store retries
  EXPECT_TRUE(scene.service().store().failing());
  scene.disk().StopRefusing();
  AwaitThat([&] { return !scene.service().store().failing(); });  // without any call
  EXPECT_OK(scene.Create());
}

absl::Status FailureToOpen(const FaultDisk& disk) {
  const absl::Status status = Store::Open(kStorePath, {.vfs = disk.vfs()}).status();
  EXPECT_THAT(std::string(status.message()), testing::HasSubstr("it is unchanged"));
  return status;
}

// The error does not say that the store is damaged or must be moved away.
TEST(DiskFailure, ADiskErrorAtTheStartIsNotReportedAsDamage) {
  for (const FaultDisk::Refusal refusal : kRefusals) {
    FaultDisk disk;
    disk.Refuse(refusal, 0);
    const absl::Status status = FailureToOpen(disk);
    EXPECT_THAT(status, StatusIs(absl::StatusCode::kUnavailable,
                                 testing::Not(testing::HasSubstr("move it away"))))
        << NameOf(refusal);
    disk.StopRefusing();
    EXPECT_OK(Store::Open(kStorePath, {.vfs = disk.vfs()}));
  }
}

// The request is refused because of a result in its group. The result does not fit on the disk, so
// the request runs again without it.
TEST(DiskFailure, ARefusalIsNotToldIfItsGroupFails) {
  FaultDisk disk;
  Store::Options options;
  options.delay = kNever;
  options.retry = std::chrono::milliseconds(1);
  options.stall = kNever;
  options.reserve_bytes = 0;
  options.vfs = disk.vfs();
  ASSERT_OK_AND_ASSIGN(const auto store, Store::Open(kStorePath, options));
  disk.SetCapacity(disk.bytes_used() + 100'000);
  store->RecordResult(99, {.point = 0, .samples = 1, .result = std::string(400'000, 'x')});
  const auto refuse_if_there = [](Database& database) {
    if (CountResults(database, 99) > 0) database.Fail(absl::AlreadyExistsError("a result"));
  };
  EXPECT_OK(store->Commit(refuse_if_there));
  disk.StopRefusing();
  AwaitWritten(*store);
  EXPECT_THAT(store->Commit(refuse_if_there), StatusIs(absl::StatusCode::kAlreadyExists));
}

// The disk is full, but the log can be overwritten.
TEST(DiskFailure, OnAFullDiskJobsCanBeCancelledAndDeleted) {
  Scene scene;
  Store& store = scene.service().store();
  store.RecordResult(99, {.point = 0, .samples = 1, .result = std::string(100'000, 'x')});
  EXPECT_OK(store.Flush());  // a long log, which is written back
  scene.disk().SetCapacity(scene.disk().bytes_used());
  EXPECT_OK(scene.Delete());
  EXPECT_TRUE(scene.IsDeleted());
  EXPECT_OK(scene.Cancel());
  EXPECT_EQ(scene.service().AwaitEnd(scene.running()).state(), EnsembleJob::CANCELLED);
}

void RecordLarge(Store& store, int64_t job) {
  for (int point = 0; point < 100; ++point) {
    store.RecordResult(job, {.point = point, .result = "x", .details = std::string(20'000, 'x')});
  }
}

// Two jobs of 2 MB each. The file has no room for the first one's log, so that not even a deletion
// has room in the log.
TEST(DiskFailure, OnAFullDiskTheReserveLetsALargeJobBeDeleted) {
  FaultDisk disk;
  Store::Options options;
  options.stall = kNever;
  options.retry = std::chrono::milliseconds(1);
  options.reserve_bytes = 4'000'000;
  options.vfs = disk.vfs();
  ASSERT_OK_AND_ASSIGN(const auto store, Store::Open(kStorePath, options));
  RecordLarge(*store, 7);
  AwaitWritten(*store);
  disk.SetCapacity(disk.bytes_used() + 200'000);
  RecordLarge(*store, 8);
  AwaitThat([&] { return store->failing(); });
  ASSERT_OK(store->CommitDeletion([](Database& database) { DeleteJob(database, 7); }));
  AwaitWritten(*store);
  EXPECT_EQ(*store->Read([](Database& database) { return CountResults(database, 8); }), 100);
}

// A job that succeeded, with results of 20 kB each. Its rows may have to wait for the disk.
std::string RecordEndedJob(Store& store, uint64_t seed, int points) {
  JobRecord record;
  record.id = absl::StrCat("ended-", seed);
  record.principal = LocalPrincipal().name;
  record.spec = SpecBytes(Equilibrium(points, 1, seed));
  record.engine_version = EngineVersion();
  record.points = points;
  const auto inserted = std::make_shared<JobRecord>(record);
  store.Record([inserted](Database& database) { InsertJob(database, *inserted); });
  EXPECT_OK(store.Flush());
  const std::string details = LargeDetails(2500);
  for (int point = 0; point < points; ++point) {
    v1::PointResult result;
    result.set_index(point);
    store.RecordResult(inserted->sequence,
                       {.point = point, .result = DeterministicBytes(result), .details = details});
  }
  JobEnd end;
  end.time = absl::Now();
  end.numbers.points_done = points;
  store.RecordSoon(
      [inserted, end](Database& database) { EndJob(database, inserted->sequence, end); });
  return record.id;
}

// Three jobs on a disk of 20 MiB with the usual reserve: one has ended, the results of the second
// do not fit, and the third still computes. Then the disk is completely full.
TEST(DiskFailure, ADiskOf20MiBThatIsFullIsFreedByADeletionAndNothingIsLost) {
  FaultDisk undisturbed;
  ServiceOnDisk elsewhere(undisturbed);
  const auto expected = elsewhere.Create(Equilibrium(3, 3, 9), "");
  ASSERT_OK(expected);
  elsewhere.AwaitEnd(IdOf(*expected));

  FaultDisk disk;
  disk.SetCapacity(20 << 20);
  {
    Turnstile turnstile;
    ServiceOnDisk service(disk, &turnstile, Store::Options().reserve_bytes);
    Store& store = service.store();
    const std::string running = IdOf(*service.Create(Equilibrium(3, 3, 9), ""));
    turnstile.AwaitWaiting();
    const std::string first = RecordEndedJob(store, 1, 100);
    AwaitWritten(store);
    const std::string second = RecordEndedJob(store, 2, 100);
    AwaitThat([&] { return store.failing(); });
    disk.SetCapacity(disk.bytes_used());
    absl::Status refused;
    for (uint64_t seed = 100; refused.ok(); ++seed) {
      refused = service.Create(Equilibrium(1000, 2, seed), "").status();
    }
    EXPECT_THAT(refused, IsError(absl::StatusCode::kUnavailable, "STORE_FULL"));
    turnstile.AdmitAll();
    EXPECT_EQ(service.Get(running)->state(), EnsembleJob::RUNNING);
    EXPECT_TRUE(store.failing());

    EXPECT_OK(service.Delete(first));
    EXPECT_EQ(service.AwaitEnd(running).state(), EnsembleJob::SUCCEEDED);
    EXPECT_EQ(service.Results(running), elsewhere.Results(IdOf(*expected)));
    EXPECT_EQ(service.AwaitEnd(second).state(), EnsembleJob::SUCCEEDED);
    EXPECT_EQ(service.Results(second).size(), 100u);
    EXPECT_OK(service.Create(Equilibrium(1, 2, 3), ""));
    EXPECT_FALSE(store.failing());
  }
  ASSERT_OK_AND_ASSIGN(const auto summary, CheckStore(kStorePath, disk.vfs()));
  EXPECT_THAT(summary.problems, IsEmpty());
}

// Results that do not fit on the disk wait, and do not delay requests that free space.
TEST(DiskFailure, OnAFullDiskRequestsGoBeforeRecordsThatDoNotFit) {
  Scene scene;
  Store& store = scene.service().store();
  scene.disk().SetCapacity(scene.disk().bytes_used() + 100'000);
  store.RecordResult(99, {.point = 0, .samples = 1, .result = std::string(400'000, 'x')});
  EXPECT_FALSE(store.Flush().ok());
  EXPECT_TRUE(store.failing());
  EXPECT_OK(scene.Delete());
  EXPECT_TRUE(store.failing());
  AwaitThat([&] { return store.counts().pending_writes == 1; });  // after the sweeper's steps
  scene.disk().StopRefusing();
  AwaitWritten(store);
  store.AwaitSwept();
  EXPECT_EQ(store.counts().pending_writes, 0);
}

// Some of many records fit. The store writes them in smaller groups.
TEST(DiskFailure, OnAFullDiskRecordsThatFitAreWritten) {
  Scene scene;
  Store& store = scene.service().store();
  scene.disk().SetCapacity(scene.disk().bytes_used() + 300'000);
  for (int point = 0; point < 1000; ++point) {
    store.RecordResult(99, {.point = point, .samples = 1, .result = std::string(1000, 'x')});
  }
  EXPECT_FALSE(store.Flush().ok());
  AwaitThat([&] { return store.counts().pending_writes < 900; });
  EXPECT_GT(store.counts().pending_writes, 100);
}

TEST(DiskFailure, WorkersWaitWhenTheirResultsTakeTooMuchMemory) {
  FaultDisk disk;
  Store::Options options;
  options.stall = kNever;
  options.retry = std::chrono::milliseconds(1);
  options.max_pending_bytes = 1000;
  options.vfs = disk.vfs();
  ASSERT_OK_AND_ASSIGN(const auto opened, Store::Open(kStorePath, options));
  Store& store = *opened;
  disk.Refuse(Refusal::kWriteError, disk.operation_count());
  store.RecordResult(99, {.point = 0, .samples = 1, .result = std::string(1001, 'x')});
  EXPECT_FALSE(store.Flush().ok());
  std::atomic<bool> has_room = false;
  std::thread worker([&] {
    store.AwaitRoom();
    has_room = true;
  });
  const int64_t refusals = disk.refusals();
  AwaitThat([&] { return disk.refusals() >= refusals + 3; });
  EXPECT_FALSE(has_room);
  disk.StopRefusing();
  worker.join();
  EXPECT_TRUE(has_room);
}

// The delay collects small batches. It does not delay threads that wait for room.
TEST(DiskFailure, ManyWritesAreNotDelayed) {
  FaultDisk disk;
  Store::Options options;
  options.stall = kNever;
  options.delay = kNever;
  options.max_pending = 10;
  options.vfs = disk.vfs();
  ASSERT_OK_AND_ASSIGN(const auto store, Store::Open(kStorePath, options));
  std::promise<void> stored;
  for (int point = 0; point < 6; ++point) {
    store->RecordResult(99, {.point = point, .samples = 1, .result = "x"}, [&](int64_t number) {
      if (number == 6) stored.set_value();
    });
  }
  EXPECT_EQ(stored.get_future().wait_for(kPatience), std::future_status::ready);
}

// ---- a whole life with one disk error ----

// Retries until there is an answer, as the client library does.
std::string CreateAtLast(ServiceOnDisk& service, uint64_t seed) {
  while (true) {
    const auto job = service.Create(Equilibrium(2, 3, seed), absl::StrCat("request-", seed));
    if (job.ok()) return IdOf(*job);
  }
}

// Submits and finishes three jobs. False if the disk rejected nothing.
bool LiveWithARefusal(Refusal refusal, size_t at, const std::vector<std::string>& results) {
  FaultDisk disk;
  { ServiceOnDisk made(disk); }
  disk.Refuse(refusal, disk.operation_count() + at, 1);
  {
    ServiceOnDisk service(disk);
    if (!service.status().ok()) return disk.refusals() > 0;  // the start failed, which is permitted
    service.WriteLogBackOften();
    for (const uint64_t seed : {7u, 8u, 9u}) {
      EXPECT_EQ(service.AwaitEnd(CreateAtLast(service, seed)).state(), EnsembleJob::SUCCEEDED);
    }
    const std::vector<DiskOperation> done = disk.operations();
    for (const Survival survival : {Survival::kNothing, Survival::kTornSectors}) {
      FaultDisk left(AfterPowerCut({}, done, done.size(), survival, at));
      ServiceOnDisk again(left);
      EXPECT_OK(again.status());
      for (const uint64_t seed : {7u, 8u, 9u}) EXPECT_EQ(Scene::Count(again, seed), 1);
      for (const EnsembleJob& job : again.List()) {
        EXPECT_EQ(job.state(), EnsembleJob::SUCCEEDED);
        if (job.spec().seed() == 7) {
          EXPECT_EQ(again.Results(IdOf(job)), results);
        }
      }
      const auto summary = CheckStore(kStorePath, left.vfs());
      EXPECT_TRUE(summary.ok() && summary->sound());
    }
  }
  return disk.refusals() > 0;
}

// The disk fails once, at each operation of a life in turn, and the power is cut at the end of the
// life.
TEST(DiskFailure, AfterADiskErrorAtAnyCallAcknowledgedDataIsThere) {
  const size_t stride = IsLong() ? 1 : 3;
  FaultDisk undisturbed;
  ServiceOnDisk service(undisturbed);
  const std::string id = CreateAtLast(service, 7);
  service.AwaitEnd(id);
  const std::vector<std::string> results = service.Results(id);
  for (const Refusal refusal : kRefusals) {
    int refused = 0;
    for (size_t at = 0; at < 150; at += stride) {
      SCOPED_TRACE(absl::StrCat(NameOf(refusal), " at ", at));
      refused += LiveWithARefusal(refusal, at, results) ? 1 : 0;
    }
    EXPECT_GT(refused, 3);
  }
}

}  // namespace
}  // namespace ballpiston::server
