#include "tests/simulation/simulation.h"

#include <csignal>
#include <deque>

#include "absl/strings/str_join.h"
#include "server/store/job_record.h"
#include "server/store/sweeper.h"
#include "tests/fault/store/power_cut.h"

namespace ballpiston::server {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds kBetweenCalls(5), kBetweenEvents(40), kLongestTrouble(60);
constexpr milliseconds kSlowOperation(20);
constexpr seconds kHang(20);
constexpr uint64_t kMostOperations = 30;
constexpr hours kPeace(6);  // enough for all jobs
constexpr size_t kStoryLines = 60;

// A store whose jobs are all deleted may use this many bytes more than a new one, because some
// trees keep a page more. One job of the largest kind takes as many.
constexpr int64_t kBytesThatStay = 48 << 10;

// These objects survive when the simulated server dies.
struct Left {
  DiskFiles disk;
  std::string computing;  // the record of crashes
};

class Simulation {
 public:
  explicit Simulation(const SimulationOptions& options)
      : options_(options),
        machine_(options.seed),
        disk_(std::make_unique<FaultDisk>()),
        world_{.machine = machine_,
               .expectations = expectations_,
               .habits = options.habits,
               .life = [this] { return HasDied() ? nullptr : life_; },
               .troubles = [this] { return troubles_; },
               .is_in_trouble = [this] { return is_in_trouble_; },
               .tell = [this](const std::string& line) { Tell(line); }} {}

  SimulationReport Run() {
    try {
      machine_.Run([this] { Guard([this] { Live(); }); });
    } catch (const std::runtime_error& stuck) {
      Note("stuck", "", stuck.what());
      new std::shared_ptr<Life>(std::move(life_));  // leaked: its threads never end
      disk_.release();
    }
    return {.finding = finding_,
            .steps = machine_.switches(),
            .calls = calls_,
            .deaths = deaths_,
            .last_bits = machine_.Bits()};
  }

 private:
  bool IsOver() const { return finding_.has_value() || machine_.switches() >= options_.steps; }

  void Live() {
    Start();
    bytes_at_first_ = BytesOfStore();
    std::vector<Machine::Fiber*> clients;
    for (int i = 0; i < options_.clients; ++i) {
      clients.push_back(machine_.Start([this] { Guard([this] { CallUntilPeace(); }); }));
    }
    while (!IsOver()) {
      machine_.Sleep(machine_.UpTo(kBetweenEvents));
      Guard([this] { Happen(); });
    }
    Heal();
    Revive();
    for (Machine::Fiber* client : clients) Await(client);
    if (!finding_) Guard([this] { MakePeace(); });
    End();
  }

  void Await(Machine::Fiber* thread) {
    if (machine_.Join(thread, machine_.now() + kPeace)) return;
    Note("stuck", "", "a call does not return");
    machine_.GiveUp();
  }

  void CallUntilPeace() {
    Client client(world_);
    while (!IsOver()) {
      machine_.Sleep(machine_.UpTo(kBetweenCalls));
      if (IsOver() || life_ == nullptr) continue;
      ++calls_;
      client.CallOnce();
    }
  }

  // A violation in any thread ends the simulation.
  void Guard(const std::function<void()>& run) {
    try {
      run();
    } catch (const Violation& violation) {
      Note(violation.check(), violation.job(), violation.what());
    }
  }

  void Note(const std::string& check, const std::string& job, const std::string& what) {
    if (finding_) return;
    finding_ = {.check = check, .what = what, .story = {}};
    for (const auto& [line, is_general] : story_) {
      if (is_general || job.empty() || line.find(job) != std::string::npos) {
        finding_->story.push_back(line);
      }
    }
    const size_t extra = finding_->story.size() - std::min(finding_->story.size(), kStoryLines);
    finding_->story.erase(finding_->story.begin(),
                          finding_->story.begin() + static_cast<ptrdiff_t>(extra));
  }

  void Tell(const std::string& line, bool is_general = false) {
    const double now = std::chrono::duration<double>(machine_.now() - begin_).count();
    story_.emplace_back(absl::StrFormat("%10.3f s  %s", now, line), is_general);
    if (story_.size() > 100 * kStoryLines) story_.pop_front();
  }

  // ---- events ----

  void Happen() {
    if (life_ == nullptr && machine_.Chance(0.5)) Heal();
    if (life_ == nullptr || HasDied()) return Revive();
    const uint64_t choice = machine_.Below(12);
    if (choice < 2 && options_.crashes) return Die("killed", Survival::kEverything);
    if (choice < 4 && options_.power_cuts) {
      if (machine_.Chance(0.7)) AwaitMiddleOfAWrite();
      return Die("power cut", kSurvivals[machine_.Below(std::size(kSurvivals))]);
    }
    if (choice < 5 && options_.restarts) return Restart();
    if (choice < 7 && options_.slow_disk) return SlowDown();
    if (choice < 8 && options_.full_disk) return Fill();
    if (choice < 9 && options_.bad_disk) return FailWrites();
    Heal();
  }

  void Start() {
    ++troubles_;
    auto life = std::make_shared<Life>(
        machine_, options_.cluster ? &shared_folder_ : nullptr, own_folder_.path(),
        options_.engine_crashes ? [this] { Crash(); } : std::function<void()>());
    const absl::Status started = life->status();
    Tell(absl::StrCat("the server starts: ", started.ToString()), true);
    if (started.ok()) {
      life_ = std::move(life);
    } else if (!is_in_trouble_) {
      throw Violation("start", "", started.ToString());
    }
  }

  bool HasDied() const { return life_ != nullptr && life_->is_over(); }

  void Revive() {
    if (HasDied()) End();
    if (life_ == nullptr) Start();
  }

  // In a thread of the server. The dead process goes on until Revive; its disk and its clients
  // ignore it.
  void Crash() {
    if (life_ == nullptr) return;  // it is starting
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
    life_->Die();
    std::vector<DiskOperation> operations = disk_->operations();
    for (DiskOperation& done : operations) {
      // The names of the files are flushed all the same.
      done.refused |=
          !options_.disk_flushes && done.kind == DiskOperation::Kind::kSync && !done.folder;
    }
    left_ = Left{.disk = AfterPowerCut(disk_->initial(), operations, operations.size(), survival,
                                       machine_.Bits()),
                 .computing = survival == Survival::kEverything ? Contents(Computing()) : ""};
    disk_->Refuse(FaultDisk::Refusal::kWriteError, operations.size());
  }

  // Some operations of the disk later, so mostly within a commit or a checkpoint.
  void AwaitMiddleOfAWrite() {
    BeginTrouble("the disk hangs in an operation");
    disk_->SetBeforeOperation([this, left = machine_.Below(kMostOperations)]() mutable {
      if (left-- == 0) machine_.Sleep(kHang);
    });
    machine_.Sleep(seconds(1));
  }

  void Restart() {
    Tell("the server restarts", true);
    life_->Die();
    Revive();
  }

  // Returns when no client is in a call of this life.
  void End() {
    if (life_ == nullptr) return;
    ++troubles_;
    std::shared_ptr<Life> life = std::exchange(life_, nullptr);
    life->Die();
    life->book().Shutdown();
    while (life.use_count() > 1) machine_.Sleep(milliseconds(100));
    life = nullptr;
    if (!left_) return;
    disk_ = std::make_unique<FaultDisk>(std::move(left_->disk));
    WriteFile(Computing(), left_->computing);
    left_ = std::nullopt;
    is_in_trouble_ = false;
  }

  std::string Computing() const { return own_folder_.File("computing"); }

  void BeginTrouble(const std::string& what) {
    Tell(what, true);
    ++troubles_;
    is_in_trouble_ = true;
  }

  void SlowDown() {
    const bool hangs = machine_.Chance(0.3);
    BeginTrouble(hangs ? "the disk hangs" : "the disk is slow");
    disk_->SetBeforeOperation([this, hangs] {
      if (machine_.Chance(hangs ? 0.02 : 0.5)) {
        machine_.Sleep(hangs ? Machine::Clock::duration(kHang) : machine_.UpTo(kSlowOperation));
      }
    });
  }

  void Fill() {
    BeginTrouble("the disk is full");
    disk_->SetCapacity(disk_->bytes_used() + static_cast<int64_t>(machine_.Below(64 << 10)));
  }

  void FailWrites() {
    const bool syncs = machine_.Chance(0.5);
    BeginTrouble(syncs ? "syncs fail" : "writes fail");
    disk_->Refuse(syncs ? FaultDisk::Refusal::kSyncError : FaultDisk::Refusal::kWriteError,
                  disk_->operation_count(), 1 + machine_.Below(40));
  }

  // The store notices only at its next retry that the disk works again.
  void Heal() {
    if (!is_in_trouble_) return;
    Tell("the disk works again", true);
    disk_->SetBeforeOperation(nullptr);
    disk_->StopRefusing();
    machine_.Sleep(kLongestTrouble);
    is_in_trouble_ = false;
    ++troubles_;
  }

  // ---- the end ----

  void MakePeace() {
    Tell("from now on nothing fails", true);
    Client client(world_);
    const auto until = machine_.now() + kPeace;
    do {
      machine_.Sleep(kLongestTrouble);
      Revive();
      client.List();
    } while (!AllHaveEnded() && machine_.now() < until);
    expectations_.ExpectAllEnded();
    for (const std::string& id : expectations_.Ids()) {
      client.Read(id);
      if (options_.habits.watches) WatchToTheEnd(client, id);
    }
    for (const std::string& id : expectations_.Ids()) client.Delete(id);
    client.List();
    Await(machine_.Start([this] { life_->store().AwaitSwept(); }));
    const int64_t bytes = BytesOfStore();
    if (bytes > bytes_at_first_ + kBytesThatStay) {
      throw Violation(
          "space", "",
          absl::StrCat(bytes, " bytes after all deletions, ", bytes_at_first_, " at first"));
    }
  }

  int64_t BytesOfStore() {
    const absl::StatusOr<int64_t> bytes = life_->store().Read(UsedBytes);
    if (!bytes.ok()) throw Violation("space", "", bytes.status().ToString());
    return *bytes;
  }

  // Several watches, because the client may leave before a watch ends.
  void WatchToTheEnd(Client& client, const std::string& id) {
    for (int i = 0; i < 3; ++i) client.Watch(id);
  }

  bool AllHaveEnded() const {
    return std::ranges::all_of(expectations_.all(), [](const auto& job) {
      return job.second.is_deleted || HasEnded(job.second.state);
    });
  }

  const SimulationOptions options_;
  Machine machine_;
  const Machine::Clock::time_point begin_ = machine_.now();
  Expectations expectations_;
  std::unique_ptr<FaultDisk> disk_;
  FakeFiles shared_folder_;
  TemporaryFolder own_folder_;
  std::optional<Left> left_;  // until the next life
  std::shared_ptr<Life> life_;
  ClientWorld world_;
  uint64_t troubles_ = 0;
  bool is_in_trouble_ = false;
  uint64_t calls_ = 0, deaths_ = 0;
  int64_t bytes_at_first_ = 0;
  std::deque<std::pair<std::string, bool>> story_;
  std::optional<Finding> finding_;
};

}  // namespace

SimulationReport Simulate(const SimulationOptions& options) { return Simulation(options).Run(); }

std::string TextOf(const SimulationOptions& o) {
  std::vector<std::string> happens = {absl::StrCat(o.clients, " clients")};
  const auto add = [&](bool does, const char* what) {
    if (does) happens.push_back(what);
  };
  add(o.crashes, "crashes");
  add(o.power_cuts, "power cuts");
  add(o.restarts, "restarts");
  add(o.slow_disk, "a slow disk");
  add(o.full_disk, "a full disk");
  add(o.bad_disk, "a bad disk");
  add(o.engine_crashes, "an engine that crashes");
  add(o.cluster, "a cluster");
  add(o.habits.cancels, "cancellations");
  add(o.habits.deletes, "deletions");
  add(o.habits.watches, "watches");
  add(o.habits.retries, "retries");
  return absl::StrCat("seed ", o.seed, ", ", o.steps, " steps: ", absl::StrJoin(happens, ", "));
}

SimulationOptions Shrunk(SimulationOptions options, const Finding& finding, int runs) {
  const auto still_fails = [&](const SimulationOptions& fewer) {
    if (runs-- <= 0) return false;
    const SimulationReport report = Simulate(fewer);
    return report.finding && report.finding->check == finding.check;
  };
  const auto try_with = [&](const std::function<void(SimulationOptions&)>& change) {
    SimulationOptions fewer = options;
    change(fewer);
    if (still_fails(fewer)) options = fewer;
  };
  using Flag = bool SimulationOptions::*;
  for (const Flag flag :
       {&SimulationOptions::crashes, &SimulationOptions::power_cuts, &SimulationOptions::restarts,
        &SimulationOptions::slow_disk, &SimulationOptions::full_disk, &SimulationOptions::bad_disk,
        &SimulationOptions::engine_crashes, &SimulationOptions::cluster}) {
    try_with([flag](SimulationOptions& fewer) { fewer.*flag = false; });
  }
  using Habit = bool ClientHabits::*;
  for (const Habit habit : {&ClientHabits::cancels, &ClientHabits::deletes, &ClientHabits::watches,
                            &ClientHabits::retries}) {
    try_with([habit](SimulationOptions& fewer) { fewer.habits.*habit = false; });
  }
  for (int clients = 1; clients < options.clients; ++clients) {
    try_with(
        [clients](SimulationOptions& fewer) { fewer.clients = std::min(clients, fewer.clients); });
  }
  for (int i = 0; i < 12; ++i) {
    try_with([](SimulationOptions& fewer) { fewer.steps /= 2; });
  }
  return options;
}

}  // namespace ballpiston::server
