#include "server/machine_memory.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace ballpiston::server {
namespace {

struct MemoryFiles {
  std::string kills;
  std::string limit;
};

// Of the process's group and of all groups that contain it, up to the root. Version 2 first, if
// this machine has both. In a container the root may be the process's own group.
std::vector<MemoryFiles> FilesOfThisProcess(const std::string& root) {
  std::vector<MemoryFiles> found;
  std::ifstream groups(root + "/proc/self/cgroup");  // lines NUMBER:CONTROLLERS:PATH
  for (std::string line; std::getline(groups, line);) {
    const std::vector<std::string> fields = absl::StrSplit(line, absl::MaxSplits(':', 2));
    if (fields.size() != 3) continue;
    for (std::string path = fields[2] + "/"; !path.empty();) {
      path.resize(path.rfind('/'));
      const std::string v2 = absl::StrCat(root, "/sys/fs/cgroup", path);
      if (fields[0] == "0") found.push_back({v2 + "/memory.events", v2 + "/memory.max"});
      const std::string v1 = absl::StrCat(root, "/sys/fs/cgroup/memory", path);
      if (fields[1] != "memory") continue;
      found.push_back({v1 + "/memory.oom_control", v1 + "/memory.limit_in_bytes"});
    }
  }
  return found;
}

// The number after the word `oom_kill`. The file has lines NAME NUMBER.
std::optional<int64_t> KillsIn(const std::string& path) {
  std::ifstream file(path);
  int64_t number = 0;
  for (std::string name; file >> name >> number;) {
    if (name == "oom_kill") return number;
  }
  return std::nullopt;
}

}  // namespace

OutOfMemoryKills ReadOutOfMemoryKills(const std::string& root) {
  std::string boot;
  std::getline(std::ifstream(root + "/proc/sys/kernel/random/boot_id"), boot);
  if (boot.empty()) return {};
  for (const MemoryFiles& files : FilesOfThisProcess(root)) {
    struct stat counter {};
    const std::optional<int64_t> kills = KillsIn(files.kills);
    if (!kills || stat(files.kills.c_str(), &counter) != 0) continue;
    return {absl::StrCat(boot, " ", counter.st_ino, " ", files.kills), *kills};
  }
  return {};
}

double MachineMemory(const std::string& root) {
  double bytes =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  for (const MemoryFiles& files : FilesOfThisProcess(root)) {
    double limit = 0;  // without a limit the file has the word `max` or a huge number
    if (std::ifstream(files.limit) >> limit) bytes = std::min(bytes, limit);
  }
  return bytes;
}

}  // namespace ballpiston::server
