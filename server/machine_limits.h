// The memory and the cores that this process can use, and the kernel's kills for want of memory: of
// the process's control group (cgroup version 1 or 2), and of the machine.
#pragma once

#include <cstdint>
#include <string>

namespace ballpiston::server {

// How often the kernel has killed a process of a group for want of memory. The counts of two times
// can be compared if the group is the same. No group: the kernel does not tell.
struct OutOfMemoryKills {
  std::string group = {};  // with the boot's identity
  int64_t kills = 0;
};

// `root`: the folder of /proc and /sys.
OutOfMemoryKills ReadOutOfMemoryKills(const std::string& root = "");

// Bytes of memory, at most the limits of the group and of those that contain it.
double MachineMemory(const std::string& root = "");

// Number of cores in this thread's affinity mask, at most the quotas of the group and of those that
// contain it, rounded up. At least 1.
int MachineCores(const std::string& root = "");

}  // namespace ballpiston::server
