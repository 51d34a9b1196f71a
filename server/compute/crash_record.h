// What this process computes, on disk before it is computed, so that the next process knows what
// killed this one.
//
// The record is a small file in memory (mmap), which the kernel keeps when the process dies. It is
// never synced: a write takes some nanoseconds, and only a power cut loses it, which counts for
// nothing. A death of the process counts if the process died of itself in a thread that computed a
// run (NoteDeath), or if the kernel killed it for want of memory (OutOfMemoryKills). It counts once
// for each run that was being computed. Properties, each with a test of its name:
//   1. TwoDeathsWithDifferentRunsMakeASuspectOfTheCommonOne.
//   2. AKillFromOutsideKeepsThePointsOfTheLastDeath. It counts for nothing.
//   3. AStoredChunkClearsTheRun.
//   4. AnOutOfMemoryKillCounts.
//   5. ADeathInAnExaminationCountsForItsRunAlone.
//   6. AThreadWithoutRoomInTheRecordWaits. So no death is blamed on the wrong run.
// A run that dies twice is computed alone (Scheduler), so at its third death nothing else can be
// the cause. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "server/machine_limits.h"
#include "server/mutex.h"

namespace ballpiston::server {

// After so many deaths a run is computed alone, and after so many it is computed no more.
inline constexpr int kDeathsOfASuspect = 2;
inline constexpr int kMostDeaths = 3;

// RunRequest's key and generation.
struct RunName {
  int64_t run = 0;
  int64_t generation = 0;

  friend auto operator<=>(const RunName&, const RunName&) = default;
};

// In this folder, systemd's unit leaves a file of this name after an out-of-memory kill.
inline constexpr char kOutOfMemoryFile[] = "out-of-memory";

class CrashRecord {
  struct Slot;

 public:
  // While an entry lives, its thread computes the point, and can note its own death, even if its
  // stack is full. Without a point the thread examines what is known of the run, which may be
  // paused: a death in this thread counts for this run alone, and a death in another thread does
  // not count for it. If one thread has several entries, the newest counts. If the record has no
  // free place, the constructor waits until another one ends.
  class Entry {
   public:
    Entry(CrashRecord& record, const RunName& run, std::optional<size_t> point = {});
    ~Entry();
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;

   private:
    Slot* slot_ = nullptr;
    Slot* const before_;
  };

  CrashRecord();  // in memory, of no use to a later process
  // Reads the record of the previous process in this folder, counts its death, and begins a record
  // of this process. If the disk refuses, the record is in memory, and the log says so. One object
  // at a time for a folder.
  explicit CrashRecord(const std::string& folder,
                       const OutOfMemoryKills& now = ReadOutOfMemoryKills());
  ~CrashRecord();
  CrashRecord(const CrashRecord&) = delete;
  CrashRecord& operator=(const CrashRecord&) = delete;

  // The deaths that count for the run.
  int Deaths(const RunName& run) const;
  // The points of the run that were being computed at the last of the deaths that count for it.
  std::set<size_t> LastPoints(const RunName& run) const;
  // The run's deaths count no more.
  void Clear(const RunName& run);
  // One death of the run counts from now on. No effect if none counts.
  void KeepOneDeath(const RunName& run);
  // The deaths of all other runs than these count no more.
  void ClearAllBut(const std::set<RunName>& runs);

  int64_t counted_deaths() const;  // of all processes with this record

  // This thread has received a fatal signal. Async-signal-safe.
  static void NoteDeath(int signal);

 private:
  struct Page;
  static Slot* TakeSlot(Page& page);
  // Of the previous process.
  struct End {
    int signal = 0;                                   // 0: it was killed, or it stopped
    std::map<RunName, std::set<size_t>> blamed = {};  // if its death counts; points by run
  };

  void Map(const std::string& path);
  End TakeEnd();
  bool TakeOutOfMemoryKill(const std::string& folder, const OutOfMemoryKills& now);
  void CountDeath(const RunName& run, std::set<size_t> points);

  std::unique_ptr<Page> in_memory_;
  Page* page_;
  mutable Mutex mutex_;  // guards the page's deaths
};

}  // namespace ballpiston::server
