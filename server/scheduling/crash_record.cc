#include "server/scheduling/crash_record.h"

#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <new>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "server/observability/log.h"

namespace ballpiston::server {
namespace {

constexpr std::array<char, 8> kFormat = {'b', 'p', 'c', 'r', 'a', 's', 'h', '1'};
constexpr size_t kSlots = 1024;  // as many as there can be workers
constexpr size_t kRuns = 1024;   // that have deaths; further ones are not counted

}  // namespace

// ---- the file ----

struct CrashRecord::Slot {
  std::atomic<int64_t> run = 0;  // 0: the slot is free
  std::atomic<int64_t> generation = 0;
  std::atomic<int64_t> point = -1;  // -1: none
};

struct CrashRecord::Page {
  struct RunDeaths {
    RunName run = {};  // run 0: the entry is free
    int64_t deaths = 0;
  };

  std::array<char, 8> format = kFormat;
  std::atomic<int64_t> signal = 0;  // of which the process dies
  RunName examined = {};            // by the thread that dies; run 0: none
  std::array<char, 512> group = {};
  int64_t kills = 0;  // out-of-memory kills of this group before the process started
  std::atomic<int64_t> counted_deaths = 0;
  std::array<Slot, kSlots> slots = {};
  std::array<RunDeaths, kRuns> deaths = {};
};

namespace {

// What the handler of a signal needs; zero when the process starts, so a thread need not make it.
struct OfThisThread {
  void* page;  // null unless the thread computes or examines a run
  RunName examined;
};
constinit thread_local OfThisThread this_thread = {nullptr, {}};

}  // namespace

CrashRecord::CrashRecord() : in_memory_(std::make_unique<Page>()), page_(in_memory_.get()) {}

CrashRecord::CrashRecord(const std::string& folder, const OutOfMemoryKills& now) : CrashRecord() {
  Map(folder + "/computing");
  TakeLast();
  CountDeath(KilledThePrevious(folder, now));
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
void CrashRecord::TakeLast() {
  for (Slot& slot : page_->slots) {
    const RunName run = {slot.run, slot.generation};
    if (run.run == 0) continue;
    if (slot.point >= 0) last_[run].insert(static_cast<size_t>(slot.point.load()));
    last_.try_emplace(run);
    slot.run = 0;
  }
}

std::set<RunName> CrashRecord::KilledThePrevious(const std::string& folder,
                                                 const OutOfMemoryKills& now) {
  const auto signal = static_cast<int>(page_->signal.exchange(0));
  const std::string group(page_->group.data(), strnlen(page_->group.data(), page_->group.size()));
  const std::string told = folder + "/" + kOutOfMemoryFile;
  const bool by_systemd = unlink(told.c_str()) == 0;
  const bool by_kernel = !group.empty() && group == now.group && now.kills > page_->kills;
  page_->group = {};
  now.group.copy(page_->group.data(), page_->group.size() - 1);
  page_->kills = now.kills;
  const RunName examined = std::exchange(page_->examined, {});
  if (signal == 0 && !by_systemd && !by_kernel) return {};
  std::set<RunName> runs;
  for (const auto& [run, points] : last_) runs.insert(run);
  if (signal != 0 && examined.run != 0) runs = {examined};
  const std::string reason = signal != 0
                                 ? absl::StrCat("signal ", signal, " (", strsignal(signal), ")")
                                 : "an out-of-memory kill";
  if (!runs.empty()) {
    LogError(absl::StrCat("the previous process died of ", reason, " while it computed ",
                          runs.size(), runs.size() == 1 ? " job" : " jobs"));
  }
  return runs;
}

void CrashRecord::CountDeath(const std::set<RunName>& runs) {
  if (!runs.empty()) ++page_->counted_deaths;
  MutexLock lock(mutex_);
  for (const RunName& run : runs) {
    const auto is = [](const RunName& name) {
      return [name](const Page::RunDeaths& entry) { return entry.run == name; };
    };
    auto entry = std::ranges::find_if(page_->deaths, is(run));
    if (entry == page_->deaths.end()) entry = std::ranges::find_if(page_->deaths, is({}));
    if (entry == page_->deaths.end()) continue;
    entry->deaths = entry->run == run ? entry->deaths + 1 : 1;
    entry->run = run;
  }
}

int CrashRecord::Deaths(const RunName& run) const {
  MutexLock lock(mutex_);
  for (const Page::RunDeaths& entry : page_->deaths) {
    if (entry.run == run) return static_cast<int>(entry.deaths);
  }
  return 0;
}

std::set<size_t> CrashRecord::LastPoints(const RunName& run) const {
  const auto found = last_.find(run);
  return found == last_.end() ? std::set<size_t>() : found->second;
}

void CrashRecord::Clear(const RunName& run) {
  MutexLock lock(mutex_);
  for (Page::RunDeaths& entry : page_->deaths) {
    if (entry.run == run) entry = {};
  }
}

void CrashRecord::ClearAllBut(const std::set<RunName>& runs) {
  MutexLock lock(mutex_);
  for (Page::RunDeaths& entry : page_->deaths) {
    if (!runs.contains(entry.run)) entry = {};
  }
}

int64_t CrashRecord::counted_deaths() const { return page_->counted_deaths; }

// ---- of a thread ----

CrashRecord::Computing::Computing(CrashRecord& record, const RunName& run,
                                  std::optional<size_t> point) {
  this_thread.page = record.page_;
  for (Slot& slot : record.page_->slots) {
    int64_t none = 0;
    if (slot.run != 0 || !slot.run.compare_exchange_strong(none, run.run)) continue;
    slot.generation = run.generation;
    slot.point = point ? static_cast<int64_t>(*point) : -1;
    slot_ = &slot;
    return;
  }
}

CrashRecord::Computing::~Computing() {
  if (slot_ != nullptr) slot_->run = 0;
  this_thread.page = nullptr;
}

CrashRecord::Examining::Examining(CrashRecord& record, const RunName& run) {
  this_thread = {record.page_, run};
}

CrashRecord::Examining::~Examining() { this_thread = {nullptr, {}}; }

void CrashRecord::NoteDeath(int signal) {
  auto* const page = static_cast<Page*>(this_thread.page);
  if (page == nullptr) return;
  page->examined = this_thread.examined;
  page->signal = signal;
}

}  // namespace ballpiston::server
