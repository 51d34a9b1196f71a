// The world has the state that the clients and the events of a simulation share. A run of the world
// returns its outcome.
#pragma once

#include <bitset>
#include <deque>

#include "tests/simulation/expectations.h"
#include "tests/simulation/life.h"
#include "tests/simulation/machine.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

// The kinds of events and calls that can be switched off. A client always creates, reads, lists and
// pins jobs.
enum Kind {
  kCrashes,
  kPowerCuts,
  kRestarts,
  kSlowDisk,
  kFullDisk,
  kBadDisk,
  kEngineCrashes,
  kCluster,
  kCancels,
  kDeletes,
  kWatches,
  kRetries,
  kKinds,
};
inline constexpr const char* kNamesOfKinds[kKinds] = {
    "crashes",
    "power cuts",
    "restarts",
    "a slow disk",
    "a full disk",
    "a bad disk",
    "an engine that crashes",
    "a cluster",
    "cancellations",
    "deletions",
    "watches",
    "retries",
};

struct SimulationOptions {
  uint64_t seed = 1;
  uint64_t steps = 40'000;  // switches from thread to thread before the last phase
  int clients = 4;
  std::bitset<kKinds> happens = std::bitset<kKinds>().set();
  bool disk_flushes = true;  // false: the disk reports flushes that it has not done
};

// A promise that the server broke.
struct Finding {
  std::string check;
  std::string what;
  std::vector<std::string> story;  // the last events of the job and of the server
};

class World {
 public:
  explicit World(const SimulationOptions& options) : options(options), machine(options.seed) {}

  // Null: no server.
  std::shared_ptr<Life> Server() const { return HasDied() ? nullptr : life; }
  bool HasDied() const { return life != nullptr && life->is_over; }

  // Records an event, which a failure prints. `is_general`: it concerns all jobs.
  void Tell(const std::string& line, bool is_general = false) {
    const double now = std::chrono::duration<double>(machine.now() - begin_).count();
    story_.emplace_back(absl::StrFormat("%10.3f s  %s", now, line), is_general);
    if (story_.size() > 100 * kStoryLines) story_.pop_front();
  }

  // The first violation ends the simulation.
  void Note(const Violation& violation) {
    if (finding) return;
    finding = {.check = violation.check, .what = violation.what(), .story = {}};
    std::vector<std::string>& story = finding->story;
    for (const auto& [line, is_general] : story_) {
      if (is_general || absl::StrContains(line, violation.job)) story.push_back(line);
    }
    story.erase(story.begin(), story.end() - std::min(std::ssize(story), kStoryLines));
  }

  const SimulationOptions options;
  Machine machine;
  Expectations expectations;
  std::shared_ptr<Life> life;
  // How often calls could begin to fail: the disk fails, or the server stops.
  uint64_t troubles = 0;
  bool is_in_trouble = false;
  std::optional<Finding> finding;

 private:
  static constexpr ptrdiff_t kStoryLines = 60;

  const Machine::Clock::time_point begin_ = machine.now();
  std::deque<std::pair<std::string, bool>> story_;
};

}  // namespace ballpiston::server
