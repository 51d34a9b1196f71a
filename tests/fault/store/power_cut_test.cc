// The power is cut at every write and sync of a trace. No acknowledged data is lost, no deleted job
// comes back, and unfinished jobs end with the same bytes.
//
// The trace runs once, on a disk that logs it. The files after each cut are made from that log, so
// all cuts are of the same trace.
#include "tests/fault/store/power_cut.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/store/schema.h"
#include "server/store/sqlite.h"
#include "tests/fault/store/acknowledged.h"
#include "tests/fault/store/fault_disk.h"
#include "tests/fault/store/service_on_disk.h"
#include "tests/server/requests.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;
using v1::EnsembleJob;

bool EveryCut() { return std::getenv("BALLPISTON_TORTURE") != nullptr; }

// The results of an undisturbed service.
std::vector<std::string> UndisturbedResults(const v1::EnsembleSpec& spec) {
  FaultDisk disk;
  ServiceOnDisk service(disk);
  const auto job = service.Create(spec, "");
  EXPECT_OK(job);
  const std::string id = IdOf(*job);
  EXPECT_EQ(service.AwaitEnd(id).state(), EnsembleJob::SUCCEEDED);
  return service.Results(id);
}

// Makes the calls of clients, and records the answers.
class Client {
 public:
  Client(FaultDisk& disk, Trace& trace) : disk_(disk), trace_(trace) {}

  void Create(ServiceOnDisk& service, uint64_t seed, int points, int blocks,
              const std::string& request_id) {
    TracedJob& job = trace_.jobs[seed];
    job.spec = Equilibrium(points, blocks, seed);
    job.request_id = request_id;
    job.results = UndisturbedResults(job.spec);
    job.create.made = disk_.operation_count();
    ASSERT_OK_AND_ASSIGN(const auto made, service.Create(job.spec, request_id));
    job.id = IdOf(made);
    job.create.answered = disk_.operation_count();
  }

  void Cancel(ServiceOnDisk& service, uint64_t seed) {
    TracedJob& job = trace_.jobs[seed];
    job.cancel.made = disk_.operation_count();
    ASSERT_OK(service.Cancel(job.id, absl::StrCat("cancel-", seed)));
    job.cancel.answered = disk_.operation_count();
    EXPECT_EQ(service.AwaitEnd(job.id).state(), EnsembleJob::CANCELLED);
  }

  void Delete(ServiceOnDisk& service, uint64_t seed) {
    TracedJob& job = trace_.jobs[seed];
    job.remove.made = disk_.operation_count();
    ASSERT_OK(service.Delete(job.id));
    job.remove.answered = disk_.operation_count();
    service.store().AwaitSwept();  // so that later requests write after it
  }

  void SeeSuccess(ServiceOnDisk& service, uint64_t seed) {
    TracedJob& job = trace_.jobs[seed];
    EXPECT_EQ(service.AwaitEnd(job.id).state(), EnsembleJob::SUCCEEDED);
    EXPECT_EQ(service.Results(job.id), job.results);
    job.success.made = job.success.answered = disk_.operation_count();
  }

 private:
  FaultDisk& disk_;
  Trace& trace_;
};

// Only one job can run at a time, so that the order of writes does not depend on time.
void FirstLife(FaultDisk& disk, Client& client) {
  Turnstile turnstile;
  ServiceOnDisk service(disk, &turnstile);
  ASSERT_OK(service.status());
  service.WriteLogBackOften();
  client.Create(service, 1, 2, 4, "request-1");
  turnstile.Admit(2);
  ASSERT_OK(service.store().Flush());  // two blocks of point 0
  client.Create(service, 2, 1, 2, "request-2");
  client.Cancel(service, 2);  // while it is queued
  turnstile.Admit(3);
  ASSERT_OK(service.store().Flush());  // point 0, and a block of point 1
  client.Delete(service, 2);
}

void SecondLife(FaultDisk& disk, Client& client) {
  Turnstile turnstile;
  ServiceOnDisk service(disk, &turnstile);
  ASSERT_OK(service.status());
  service.WriteLogBackOften();
  turnstile.Admit(2);  // one is left
  client.Create(service, 3, 1, 3, "request-3");
  client.Cancel(service, 3);
  turnstile.AdmitAll();
  client.SeeSuccess(service, 1);
}

void ThirdLife(FaultDisk& disk, Client& client) {
  Turnstile turnstile;
  ServiceOnDisk service(disk, &turnstile);
  ASSERT_OK(service.status());
  service.WriteLogBackOften();
  client.Create(service, 4, 1, 3, "request-4");
  turnstile.Admit(1);
  ASSERT_OK(service.store().Flush());
  client.Cancel(service, 4);  // while it runs
  client.Delete(service, 1);
  turnstile.AdmitAll();
  client.Create(service, 5, 3, 2, "");
  client.SeeSuccess(service, 5);
}

void FourthLife(FaultDisk& disk, Client& client) {
  Turnstile turnstile;
  ServiceOnDisk service(disk, &turnstile);
  ASSERT_OK(service.status());
  client.Create(service, 6, 1, 3, "request-6");
  turnstile.Admit(1);
  ASSERT_OK(service.store().Flush());
}

Trace SubmitToFinish() {
  Trace trace;
  FaultDisk disk;
  Client client(disk, trace);
  FirstLife(disk, client);
  SecondLife(disk, client);
  ThirdLife(disk, client);
  FourthLife(disk, client);
  trace.operations = disk.operations();
  return trace;
}

std::string NameOf(Survival survival) {
  const char* const names[] = {"nothing", "everything", "oldest", "newest", "sectors", "torn"};
  return names[static_cast<size_t>(survival)];
}

// Every operation, or, in the short form, some; the last number is after the end.
std::vector<size_t> CutsOf(const Trace& trace, size_t in_short_form) {
  const size_t all = trace.operations.size() + 1;
  const size_t stride = EveryCut() ? 1 : std::max<size_t>(1, all / in_short_form);
  std::vector<size_t> cuts;
  for (size_t cut = 0; cut < all; cut += stride) cuts.push_back(cut);
  return cuts;
}

void ExpectNothingIsLost(const Trace& trace, size_t cuts_in_short_form) {
  int tried = 0;
  for (const size_t cut : CutsOf(trace, cuts_in_short_form)) {
    for (const Survival survival : kSurvivals) {
      const bool random = survival != Survival::kNothing && survival != Survival::kEverything;
      for (uint64_t seed = 0; seed < (random && EveryCut() ? 10 : 1); ++seed) {
        EXPECT_THAT(WhatIsWrongAfter(trace, cut, survival, seed), IsEmpty())
            << "cut at " << cut << " of " << trace.operations.size() << ", survives "
            << NameOf(survival) << ", seed " << seed;
        ++tried;
      }
    }
  }
  std::cout << tried << " power cuts in " << trace.operations.size() << " operations\n";
}

TEST(PowerCut, NothingAcknowledgedIsLostAtAnyWriteOrSync) {
  const Trace trace = SubmitToFinish();
  ASSERT_GT(trace.operations.size(), 200u);
  ExpectNothingIsLost(trace, 25);
}

struct Outline {
  DiskOperation::Kind kind;
  std::string path;
  int64_t offset;
  size_t bytes;
  friend bool operator==(const Outline&, const Outline&) = default;
};

std::vector<Outline> OutlineOf(const Trace& trace) {
  std::vector<Outline> outline;
  for (const DiskOperation& operation : trace.operations) {
    outline.push_back({operation.kind, operation.path, operation.offset, operation.data.size()});
  }
  return outline;
}

TEST(PowerCut, TheTraceIsTheSameEachTime) {
  EXPECT_EQ(OutlineOf(SubmitToFinish()), OutlineOf(SubmitToFinish()));
}

TEST(PowerCut, TheTraceCheckpointsAndRestartsTheLog) {
  int writes_back = 0;
  int headers = 0;
  for (const DiskOperation& operation : SubmitToFinish().operations) {
    const bool is_log = operation.path.ends_with("-wal");
    if (operation.kind != DiskOperation::Kind::kWrite) continue;
    writes_back += operation.path == kStorePath ? 1 : 0;
    headers += is_log && operation.offset == 0 ? 1 : 0;
  }
  EXPECT_GT(writes_back, 20);
  EXPECT_GT(headers, 5);
}

// The comparison detects a disk that reports a flush that it has not done.
TEST(PowerCut, ADiskThatDoesNotFlushIsDetected) {
  Trace trace = SubmitToFinish();
  for (DiskOperation& operation : trace.operations) {
    // The names of the files are flushed all the same.
    if (operation.kind == DiskOperation::Kind::kSync && !operation.folder) operation.refused = true;
  }
  const size_t cut = trace.jobs.at(2).create.answered;
  EXPECT_THAT(WhatIsWrongAfter(trace, cut, Survival::kNothing, 0),
              testing::Contains("job 2 is lost"));
}

TEST(PowerCut, ADeletedJobThatComesBackIsDetected) {
  Trace trace = SubmitToFinish();
  const size_t cut = trace.jobs.at(2).remove.made;  // before the deletion
  EXPECT_THAT(WhatIsWrongAfter(trace, cut, Survival::kNothing, 0), IsEmpty());
  trace.jobs.at(2).remove.answered = 0;
  EXPECT_THAT(WhatIsWrongAfter(trace, cut, Survival::kNothing, 0),
              testing::Contains("job 2 was deleted and is back"));
}

// Both forms try every cut here. The store is created at the beginning of the trace, where the
// short form of the other tests has only one or two cuts.
TEST(PowerCut, AnInterruptedCreationIsCompletedAtTheNextStart) {
  FaultDisk disk;
  ASSERT_TRUE(OpenStoreFile(kStorePath, disk.vfs()).ok());
  const std::vector<DiskOperation> operations = disk.operations();
  ASSERT_GT(operations.size(), 10u);
  for (size_t cut = 0; cut <= operations.size(); ++cut) {
    for (const Survival survival : kSurvivals) {
      FaultDisk left(AfterPowerCut({}, operations, cut, survival, 1));
      const auto database = OpenStoreFile(kStorePath, left.vfs());
      ASSERT_TRUE(database.ok()) << database.status() << " at " << cut;
      EXPECT_EQ((*database)->First<std::string>("PRAGMA integrity_check"), "ok");
      EXPECT_EQ((*database)->Integer("PRAGMA user_version"), kSchemaVersion);
      EXPECT_EQ((*database)->Integer("SELECT count(*) FROM jobs"), 0);
    }
  }
}

// ---- the model of the disk itself ----

DiskOperation Write(int64_t offset, const std::string& data) {
  return {.path = "f", .file = 0, .offset = offset, .data = data};
}

DiskOperation Sync(bool refused = false) {
  return {.kind = DiskOperation::Kind::kSync, .path = "f", .file = 0, .refused = refused};
}

TEST(PowerCutModel, SyncedDataStaysAndOtherDataMayBeLost) {
  const std::vector<DiskOperation> operations = {Write(0, "ab"), Sync(), Write(1, "X")};
  const DiskFiles initial = {{"f", "...."}};
  EXPECT_EQ(AfterPowerCut(initial, operations, 3, Survival::kNothing, 0).at("f"), "ab..");
  EXPECT_EQ(AfterPowerCut(initial, operations, 3, Survival::kEverything, 0).at("f"), "aX..");
}

TEST(PowerCutModel, ASyncInProgressGuaranteesNothing) {
  const std::vector<DiskOperation> operations = {Write(0, "ab"), Sync()};
  EXPECT_EQ(AfterPowerCut({{"f", ".."}}, operations, 1, Survival::kNothing, 0).at("f"), "..");
}

TEST(PowerCutModel, AfterAFailedSyncALaterOneDoesNotMakeItSafe) {
  const std::vector<DiskOperation> operations = {Write(0, "a"), Sync(true), Write(1, "b"), Sync()};
  EXPECT_EQ(AfterPowerCut({{"f", ".."}}, operations, 4, Survival::kNothing, 0).at("f"), ".b");
}

TEST(PowerCutModel, ANameIsSafeWhenItsFolderWasFlushed) {
  DiskOperation create = {.kind = DiskOperation::Kind::kCreate, .path = "g", .file = 1};
  DiskOperation sync = {.kind = DiskOperation::Kind::kSync, .path = "g", .file = 1};
  EXPECT_THAT(AfterPowerCut({}, {create, sync}, 2, Survival::kNothing, 0), IsEmpty());
  sync.folder = true;
  EXPECT_THAT(AfterPowerCut({}, {create, sync}, 2, Survival::kNothing, 0), Not(IsEmpty()));
}

TEST(PowerCutModel, ASectorIsOldOrNewOrTorn) {
  const std::string before(4096, 'o');
  const std::vector<DiskOperation> operations = {Write(0, std::string(4096, 'n'))};
  int mixed = 0;
  int torn = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto left = [&](Survival survival) {
      return AfterPowerCut({{"f", before}}, operations, 1, survival, seed).at("f");
    };
    const std::string sectors = left(Survival::kSectors);
    for (size_t i = 0; i < 4096; i += 512) EXPECT_EQ(sectors[i], sectors[i + 511]);
    mixed += sectors.find('o') != std::string::npos && sectors.find('n') != std::string::npos;
    const std::string halves = left(Survival::kTornSectors);
    for (size_t i = 0; i < 4096; i += 512) torn += halves[i] != halves[i + 511] ? 1 : 0;
  }
  EXPECT_GT(mixed, 10);
  EXPECT_GT(torn, 5);
}

}  // namespace
}  // namespace ballpiston::server
