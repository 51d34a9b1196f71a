// A simulated world from one seed: a server with its clients, cluster, disk failures and crashes.
#pragma once

#include "tests/simulation/world.h"

namespace ballpiston::server {

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

std::string TextOf(const SimulationOptions& options);

// Removes kinds of events, clients and steps as long as the same check fails. Simulates at most
// `runs` worlds.
SimulationOptions Shrunk(SimulationOptions options, const Finding& finding, int runs);

}  // namespace ballpiston::server
