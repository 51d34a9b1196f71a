#include "server/compute/crash_record.h"

#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <new>
#include <optional>
#include <thread>
#include <vector>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "server/fatal_signals.h"
#include "server/host.h"
#include "server/status/log.h"

namespace ballpiston::server {
namespace {

constexpr std::array<char, 8> kFormat = {'b', 'p', 'c', 'r', 'a', 's', 'h', '3'};
// Enough for 1,024 workers and for calls that examine runs.
constexpr size_t kSlots = 2048;
constexpr size_t kDeaths = 2048;  // further deaths are not counted

// Of a slot whose contents are being written.
constexpr int64_t kTaken = -1;
constexpr int64_t kNoPoint = -1;

}  // namespace

// ---- the file ----

// What a thread does.
struct CrashRecord::Slot {
  std::atomic<int64_t> run = 0;  // 0: the slot is free
  int64_t generation = 0;
  int64_t point = kNoPoint;         // kNoPoint: the thread examines the run
  std::atomic<int64_t> signal = 0;  // of which the thread dies
};

struct CrashRecord::Page {
  // A run has an entry for each point that was being computed at its last death, at least one.
  struct Death {
    RunName run = {};  // run 0: the entry is free
    int64_t point = kNoPoint;
    int64_t deaths = 0;  // of the run
  };

  std::array<char, 8> format = kFormat;
  std::array<char, 512> group = {};
  int64_t kills = 0;  // out-of-memory kills of this group before the process started
  std::atomic<int64_t> counted_deaths = 0;
  std::array<Slot, kSlots> slots = {};
  std::array<Death, kDeaths> deaths = {};
};

CrashRecord::CrashRecord() : in_memory_(std::make_unique<Page>()), page_(in_memory_.get()) {}

CrashRecord::CrashRecord(const std::string& folder, const OutOfMemoryKills& now) : CrashRecord() {
  Map(folder + "/computing");
  const auto [signal, blamed] = TakeEnd();
  const bool is_out_of_memory = TakeOutOfMemoryKill(folder, now);
  if (blamed.empty() || (signal == 0 && !is_out_of_memory)) return;
  const std::string reason = signal != 0
                                 ? absl::StrCat("signal ", signal, " (", strsignal(signal), ")")
                                 : "an out-of-memory kill";
  LogError(absl::StrCat("the previous process died of ", reason, " while it computed ",
                        blamed.size(), blamed.size() == 1 ? " job" : " jobs"));
  ++page_->counted_deaths;
  for (const auto& [run, points] : blamed) CountDeath(run, points);
}

CrashRecord::~CrashRecord() {
  if (in_memory_ == nullptr) munmap(page_, sizeof(Page));
}

// The blocks of the file are allocated first: a write to the memory of a file on a full disk would
// be a SIGBUS.
void CrashRecord::Map(const std::string& path) {
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  const absl::Cleanup close_file = [file] { close(file); };
  const int error = file < 0 ? errno : posix_fallocate(file, 0, sizeof(Page));
  void* const memory =
      error != 0 ? MAP_FAILED
                 : mmap(nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (memory == MAP_FAILED) {
    return LogError(absl::StrCat(path, " cannot be used (", strerror(error != 0 ? error : errno),
                                 "): if the engine crashes the server, the next start will not "
                                 "know which job did it"));
  }
  page_ = static_cast<Page*>(memory);
  if (page_->format != kFormat) new (page_) Page();
  in_memory_.reset();
}

// Frees the slots, so that a kill during the start counts nothing twice.
CrashRecord::End CrashRecord::TakeEnd() {
  End end;
  std::optional<RunName> examined;  // by the thread that died
  for (Slot& slot : page_->slots) {
    const RunName run = {slot.run.exchange(0), slot.generation};
    const auto signal = static_cast<int>(slot.signal.exchange(0));
    if (run.run <= 0) continue;
    if (signal != 0) end.signal = signal;
    if (slot.point != kNoPoint) end.blamed[run].insert(static_cast<size_t>(slot.point));
    if (slot.point == kNoPoint && signal != 0) examined = run;
  }
  if (examined) end.blamed = {{*examined, {}}};
  return end;
}

// Whether the previous process was killed for want of memory.
bool CrashRecord::TakeOutOfMemoryKill(const std::string& folder, const OutOfMemoryKills& now) {
  const std::string group(page_->group.data(), strnlen(page_->group.data(), page_->group.size()));
  const bool by_kernel = !group.empty() && group == now.group && now.kills > page_->kills;
  page_->group = {};
  now.group.copy(page_->group.data(), page_->group.size() - 1);
  page_->kills = now.kills;
  const bool by_systemd = unlink((folder + "/" + kOutOfMemoryFile).c_str()) == 0;
  return by_kernel || by_systemd;
}

// Without points, those of the run's death before.
void CrashRecord::CountDeath(const RunName& run, std::set<size_t> points) {
  const int deaths = Deaths(run) + 1;
  if (points.empty()) points = LastPoints(run);
  std::vector<int64_t> entries(points.begin(), points.end());
  if (entries.empty()) entries.push_back(kNoPoint);
  Clear(run);
  MutexLock lock(mutex_);
  for (Page::Death& entry : page_->deaths) {
    if (entry.run != RunName() || entries.empty()) continue;
    entry = {run, entries.back(), deaths};
    entries.pop_back();
  }
}

int CrashRecord::Deaths(const RunName& run) const {
  MutexLock lock(mutex_);
  const auto entry = std::ranges::find(page_->deaths, run, &Page::Death::run);
  return entry == page_->deaths.end() ? 0 : static_cast<int>(entry->deaths);
}

std::set<size_t> CrashRecord::LastPoints(const RunName& run) const {
  std::set<size_t> points;
  MutexLock lock(mutex_);
  for (const Page::Death& entry : page_->deaths) {
    if (entry.run == run && entry.point != kNoPoint) {
      points.insert(static_cast<size_t>(entry.point));
    }
  }
  return points;
}

void CrashRecord::Clear(const RunName& run) {
  MutexLock lock(mutex_);
  std::ranges::replace(page_->deaths, run, Page::Death(), &Page::Death::run);
}

void CrashRecord::KeepOneDeath(const RunName& run) {
  MutexLock lock(mutex_);
  for (Page::Death& entry : page_->deaths) {
    if (entry.run == run) entry.deaths = 1;
  }
}

void CrashRecord::ClearAllBut(const std::set<RunName>& runs) {
  MutexLock lock(mutex_);
  std::ranges::replace_if(
      page_->deaths, [&](const RunName& run) { return !runs.contains(run); }, Page::Death(),
      &Page::Death::run);
}

int64_t CrashRecord::counted_deaths() const { return page_->counted_deaths; }

// ---- of a thread ----

// Null if all slots are taken.
CrashRecord::Slot* CrashRecord::TakeSlot(Page& page) {
  for (Slot& slot : page.slots) {
    int64_t free = 0;
    if (slot.run == 0 && slot.run.compare_exchange_strong(free, kTaken)) return &slot;
  }
  return nullptr;
}

CrashRecord::Entry::Entry(CrashRecord& record, const RunName& run, std::optional<size_t> point)
    : before_(static_cast<Slot*>(PointerOfThread())) {
  static thread_local const SignalStack stack;
  while ((slot_ = TakeSlot(*record.page_)) == nullptr) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  slot_->generation = run.generation;
  slot_->point = point ? static_cast<int64_t>(*point) : kNoPoint;
  slot_->run = run.run;  // last, because the process may be killed at any moment
  PointerOfThread() = slot_;
}

CrashRecord::Entry::~Entry() {
  PointerOfThread() = before_;
  slot_->run = 0;
}

void CrashRecord::NoteDeath(int signal) {
  if (auto* const slot = static_cast<Slot*>(PointerOfThread())) slot->signal = signal;
}

}  // namespace ballpiston::server
