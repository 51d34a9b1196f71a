// A simulated world from one seed: a server with its clients, cluster, disk failures and crashes.
#pragma once

#include "tests/simulation/client.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

struct SimulationOptions {
  uint64_t seed = 1;
  uint64_t steps = 40'000;  // switches from thread to thread before the last phase
  int clients = 4;
  bool crashes = true;
  bool power_cuts = true;
  bool restarts = true;
  bool slow_disk = true;
  bool full_disk = true;
  bool bad_disk = true;
  bool engine_crashes = true;
  bool cluster = true;
  bool disk_flushes = true;  // false: the disk reports flushes that it has not done
  ClientHabits habits = {};
};
std::string TextOf(const SimulationOptions& options);

// A promise that the server broke.
struct Finding {
  std::string check;
  std::string what;
  std::vector<std::string> story;  // the last events of the job and of the server
};

struct SimulationReport {
  std::optional<Finding> finding;
  uint64_t steps = 0;
  uint64_t calls = 0;
  uint64_t deaths = 0;
  uint64_t last_bits = 0;  // of the random numbers: equal in two runs with the same events
};

// Runs the world. In its last phase nothing fails: every job ends, its results have the bytes of an
// undisturbed run, and deletions free the disk.
SimulationReport Simulate(const SimulationOptions& options);

// Removes kinds of events, clients and steps as long as the same check fails. Simulates at most
// `runs` worlds.
SimulationOptions Shrunk(SimulationOptions options, const Finding& finding, int runs);

}  // namespace ballpiston::server
