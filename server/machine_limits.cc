#include "server/machine_limits.h"

#include <sched.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace ballpiston::server {
namespace {

struct ControlGroup {
  bool is_version_2;
  std::string folder;
};

// The process's group and all groups that contain it, up to the root. In a container the root may
// be the process's own group.
std::vector<ControlGroup> GroupsOfThisProcess(const std::string& root,
                                              const std::string& controller) {
  std::vector<ControlGroup> found;
  std::ifstream groups(root + "/proc/self/cgroup");  // lines NUMBER:CONTROLLERS:PATH
  for (std::string line; std::getline(groups, line);) {
    const std::vector<std::string> fields = absl::StrSplit(line, absl::MaxSplits(':', 2));
    if (fields.size() != 3) continue;
    const bool is_version_2 = fields[0] == "0";
    const std::set<std::string> controllers = absl::StrSplit(fields[1], ',');
    if (!is_version_2 && !controllers.contains(controller)) continue;
    const std::string mount =
        absl::StrCat(root, "/sys/fs/cgroup", is_version_2 ? "" : "/" + controller);
    for (std::string path = fields[2] + "/"; !path.empty();) {
      path.resize(path.rfind('/'));
      found.push_back({is_version_2, mount + path});
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
  for (const auto& [is_version_2, folder] : GroupsOfThisProcess(root, "memory")) {
    const std::string file = folder + (is_version_2 ? "/memory.events" : "/memory.oom_control");
    struct stat counter {};
    const std::optional<int64_t> kills = KillsIn(file);
    if (!kills || stat(file.c_str(), &counter) != 0) continue;
    return {absl::StrCat(boot, " ", counter.st_ino, " ", file), *kills};
  }
  return {};
}

double MachineMemory(const std::string& root) {
  double bytes =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  for (const auto& [is_version_2, folder] : GroupsOfThisProcess(root, "memory")) {
    double limit = 0;  // without a limit the file has the word `max` or a huge number
    std::ifstream file(folder + (is_version_2 ? "/memory.max" : "/memory.limit_in_bytes"));
    if (file >> limit) bytes = std::min(bytes, limit);
  }
  return bytes;
}

int MachineCores(const std::string& root) {
  cpu_set_t mask;
  // It fails if the machine has more cores than the mask has bits.
  const bool has_mask = sched_getaffinity(0, sizeof(mask), &mask) == 0;
  double cores = has_mask ? CPU_COUNT(&mask) : 1.0 * std::thread::hardware_concurrency();
  for (const auto& [is_version_2, folder] : GroupsOfThisProcess(root, "cpu")) {
    double quota = 0, period = 0;  // without a quota the file has the word `max` or -1
    std::ifstream file(folder + (is_version_2 ? "/cpu.max" : "/cpu.cfs_quota_us"));
    std::ifstream period_file(folder + "/cpu.cfs_period_us");
    file >> quota;
    (is_version_2 ? file : period_file) >> period;
    if (quota > 0 && period > 0) cores = std::min(cores, std::ceil(quota / period));
  }
  return std::max(static_cast<int>(cores), 1);
}

}  // namespace ballpiston::server
