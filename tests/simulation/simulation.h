// The events of a simulated world, from one seed: a server with its clients, cluster, disk failures
// and crashes. In its last phase nothing fails: every job ends, its results have the bytes of an
// undisturbed run, and deletions free the disk.
#pragma once

#include <csignal>

#include "server/store/job_record.h"
#include "server/store/sweeper.h"
#include "tests/fault/store/power_cut.h"
#include "tests/simulation/client.h"
#include "tests/simulation/world.h"

namespace ballpiston::server {

struct SimulationReport {
  std::optional<Finding> finding;
  uint64_t steps = 0;
  uint64_t calls = 0;
  uint64_t deaths = 0;
  uint64_t last_bits = 0;  // of the random numbers: equal in two runs with the same events
};

class Simulation : World {
 public:
  using World::World;

  SimulationReport Run() {
    try {
      machine.Run([this] { Guard([this] { Live(); }); });
    } catch (const std::runtime_error& stuck) {
      Note(Violation("stuck", "", stuck.what()));
      new std::shared_ptr<Life>(std::move(life));  // leaked: its threads never end
      disk_.release();
    }
    return {finding, machine.switches(), calls_, deaths_, machine.Bits()};
  }

 private:
  bool IsOver() const { return finding || machine.switches() >= options.steps; }

  void Live() {
    Start();
    bytes_at_first_ = BytesOfStore();
    std::vector<Machine::SimulatedThread*> clients;
    for (int i = 0; i < options.clients; ++i) {
      clients.push_back(machine.Start([this] { Guard([this] { CallUntilPeace(); }); }));
    }
    while (!IsOver()) {
      machine.Sleep(machine.UpTo(kBetweenEvents));
      Guard([this] { Happen(); });
    }
    Heal();
    Revive();
    for (Machine::SimulatedThread* client : clients) Await(client);
    if (!finding) Guard([this] { MakePeace(); });
    End();
  }

  void Await(Machine::SimulatedThread* thread, std::chrono::hours limit = kPeace) {
    if (machine.Join(thread, machine.now() + limit)) return;
    Note(Violation("stuck", "", "a call or a stop does not return"));
    machine.GiveUp();
  }

  void CallUntilPeace() {
    Client client(*this);
    while (!IsOver()) {
      machine.Sleep(machine.UpTo(kBetweenCalls));
      if (IsOver() || life == nullptr) continue;
      ++calls_;
      client.CallOnce();
    }
  }

  // A violation in any thread ends the simulation.
  void Guard(const std::function<void()>& run) {
    try {
      run();
    } catch (const Violation& violation) {
      Note(violation);
    }
  }

  // ---- events ----

  void Happen() {
    if (life == nullptr && machine.Chance(0.5)) Heal();
    if (life == nullptr || HasDied()) return Revive();
    const uint64_t choice = machine.Below(12);
    if (choice < 2 && options.happens[kCrashes]) return Die("killed", Survival::kEverything);
    if (choice < 4 && options.happens[kPowerCuts]) {
      if (machine.Chance(0.7)) AwaitMiddleOfAWrite();
      return Die("power cut", kSurvivals[machine.Below(std::size(kSurvivals))]);
    }
    if (choice < 5 && options.happens[kRestarts]) return Restart();
    if (choice < 7 && options.happens[kSlowDisk]) return SlowDown();
    if (choice < 8 && options.happens[kFullDisk]) return Fill();
    if (choice < 9 && options.happens[kBadDisk]) return FailWrites();
    Heal();
  }

  void Start() {
    ++troubles;
    auto next = std::make_shared<Life>(
        machine, options.happens[kCluster] ? &shared_folder_ : nullptr, own_folder_.path(),
        options.happens[kEngineCrashes] ? [this] { Crash(); } : std::function<void()>());
    const std::string started = next->status.ToString();
    Tell("the server starts: " + started, true);
    Require(next->status.ok() || is_in_trouble, "start", "", started);
    if (next->status.ok()) life = std::move(next);
  }

  void Revive() {
    if (HasDied()) End();
    if (life == nullptr) Start();
  }

  // In a thread of the server. The dead process goes on until Revive; its disk and its clients
  // ignore it.
  void Crash() {
    if (life == nullptr) return;  // it is starting
    CrashRecord::NoteDeath(SIGSEGV);
    Fall("the engine crashes", Survival::kEverything);
  }

  void Die(const std::string& how, Survival survival) {
    if (!HasDied()) Fall(how, survival);  // the engine may have crashed meanwhile
    Revive();
  }

  // From now on the process changes nothing.
  void Fall(const std::string& how, Survival survival) {
    ++deaths_;
    Tell(how, true);
    life->is_over = true;
    std::vector<DiskOperation> operations = disk_->operations();
    for (DiskOperation& done : operations) {
      // The names of the files are flushed all the same.
      done.refused |=
          !options.disk_flushes && done.kind == DiskOperation::Kind::kSync && !done.folder;
    }
    left_ = Left{.disk = AfterPowerCut(disk_->initial(), operations, operations.size(), survival,
                                       machine.Bits()),
                 .computing = survival == Survival::kEverything ? Contents(Computing()) : ""};
    disk_->Refuse(FaultDisk::Refusal::kWriteError);
  }

  // The disk hangs after some operations. Then the server is usually within a commit or a
  // checkpoint.
  void AwaitMiddleOfAWrite() {
    BeginTrouble("the disk hangs in an operation");
    disk_->SetBeforeOperation([this, left = machine.Below(kMostOperations)]() mutable {
      if (left-- == 0) machine.Sleep(kHang);
    });
    machine.Sleep(std::chrono::seconds(1));
  }

  void Restart() {
    Tell("the server restarts", true);
    life->is_over = true;
    Revive();
  }

  // Returns when no client is in a call of this life.
  void End() {
    if (life == nullptr) return;
    ++troubles;
    std::shared_ptr<Life> last = std::exchange(life, nullptr);
    last->is_over = true;
    last->book().Shutdown();
    auto stop = [this, last = std::move(last)]() mutable {
      while (last.use_count() > 1) machine.Sleep(std::chrono::milliseconds(100));
      last = nullptr;
    };
    Await(machine.Start(std::move(stop)), kLongestStop);
    if (!left_) return;
    disk_ = std::make_unique<FaultDisk>(std::move(left_->disk));
    WriteFile(Computing(), left_->computing);
    left_ = std::nullopt;
    is_in_trouble = false;
  }

  std::string Computing() const { return own_folder_.File("computing"); }

  void BeginTrouble(const std::string& what) {
    Tell(what, true);
    ++troubles;
    is_in_trouble = true;
  }

  void SlowDown() {
    const bool hangs = machine.Chance(0.3);
    BeginTrouble(hangs ? "the disk hangs" : "the disk is slow");
    disk_->SetBeforeOperation([this, hangs] {
      if (machine.Chance(hangs ? 0.02 : 0.5)) {
        machine.Sleep(hangs ? Machine::Clock::duration(kHang) : machine.UpTo(kSlowOperation));
      }
    });
  }

  void Fill() {
    BeginTrouble("the disk is full");
    disk_->SetCapacity(disk_->bytes_used() + static_cast<int64_t>(machine.Below(64 << 10)));
  }

  void FailWrites() {
    const bool syncs = machine.Chance(0.5);
    BeginTrouble(syncs ? "syncs fail" : "writes fail");
    disk_->Refuse(syncs ? FaultDisk::Refusal::kSyncError : FaultDisk::Refusal::kWriteError,
                  1 + machine.Below(40));
  }

  // The store notices only at its next retry that the disk works again.
  void Heal() {
    if (!is_in_trouble) return;
    Tell("the disk works again", true);
    disk_->SetBeforeOperation(nullptr);
    disk_->StopRefusing();
    machine.Sleep(kLongestTrouble);
    is_in_trouble = false;
    ++troubles;
  }

  // ---- the end ----

  void MakePeace() {
    Tell("from now on nothing fails", true);
    Client client(*this);
    const auto until = machine.now() + kPeace;
    do {
      machine.Sleep(kLongestTrouble);
      Revive();
      client.List();
    } while (!AllHaveEnded() && machine.now() < until);
    expectations.ExpectAllEnded();
    for (const std::string& id : expectations.Ids()) {
      client.Read(id);
      // Several watches, because the client may leave before a watch ends.
      for (int i = 0; options.happens[kWatches] && i < 3; ++i) client.Watch(id);
    }
    for (const std::string& id : expectations.Ids()) client.Delete(id);
    client.List();
    Await(machine.Start([this] { life->store().AwaitSwept(); }));
    const int64_t bytes = BytesOfStore();
    Require(bytes <= bytes_at_first_ + kBytesThatStay, "space", "", bytes,
            " bytes after all deletions, ", bytes_at_first_, " at first");
  }

  int64_t BytesOfStore() {
    const absl::StatusOr<int64_t> bytes = life->store().Read(UsedBytes);
    Require(bytes.ok(), "space", "", bytes.status().ToString());
    return *bytes;
  }

  bool AllHaveEnded() const {
    return std::ranges::all_of(expectations.all(), [](const auto& job) {
      return job.second.is_deleted || HasEnded(job.second.state);
    });
  }

  static constexpr std::chrono::seconds kBetweenCalls{5}, kBetweenEvents{40}, kLongestTrouble{60},
      kHang{20};
  static constexpr std::chrono::milliseconds kSlowOperation{20};
  static constexpr uint64_t kMostOperations = 30;
  static constexpr std::chrono::hours kPeace{6};        // enough for all jobs
  static constexpr std::chrono::hours kLongestStop{1};  // of a server with its last calls

  // A store whose jobs are all deleted may use this many bytes more than a new one, because some
  // trees keep a page more. One job of the largest kind takes as many.
  static constexpr int64_t kBytesThatStay = 48 << 10;

  // These objects survive when the simulated server dies.
  struct Left {
    DiskFiles disk;
    std::string computing;  // the record of crashes
  };

  std::unique_ptr<FaultDisk> disk_ = std::make_unique<FaultDisk>();
  FakeFiles shared_folder_;
  const TemporaryFolder own_folder_;
  std::optional<Left> left_;  // until the next life
  uint64_t calls_ = 0, deaths_ = 0;
  int64_t bytes_at_first_ = 0;
};

}  // namespace ballpiston::server
