#include "server/machine_limits.h"

#include <sched.h>

#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

// A machine whose files of the kernel are in a temporary folder.
class MachineLimits : public testing::Test {
 protected:
  void Write(const std::string& path, const std::string& contents) {
    const std::filesystem::path file = root_.path() + path;
    std::filesystem::create_directories(file.parent_path());
    WriteFile(file, contents);
  }

  const TemporaryFolder root_;
};

TEST_F(MachineLimits, TheLimitOfAGroupThatContainsThisOneCounts) {
  Write("/proc/self/cgroup", "0::/a/b\n");
  Write("/sys/fs/cgroup/a/b/memory.max", "max\n");
  EXPECT_GT(MachineMemory(root_.path()), 3e6);
  Write("/sys/fs/cgroup/a/memory.max", "3000000\n");
  EXPECT_EQ(MachineMemory(root_.path()), 3e6);
  Write("/sys/fs/cgroup/a/b/memory.max", "2000000\n");
  EXPECT_EQ(MachineMemory(root_.path()), 2e6);
  Write("/sys/fs/cgroup/memory.max", "1000000\n");  // of a container
  EXPECT_EQ(MachineMemory(root_.path()), 1e6);
}

TEST_F(MachineLimits, ALimitOfVersionOneCounts) {
  Write("/proc/self/cgroup", "5:cpu,memory:/x\n4:memory:/a/b\n");
  Write("/sys/fs/cgroup/memory/a/memory.limit_in_bytes", "3000000\n");
  EXPECT_EQ(MachineMemory(root_.path()), 3e6);
}

TEST_F(MachineLimits, CoresAreThoseOfTheAffinityWithinAllQuotas) {
  const int all = MachineCores(root_.path());
  Write("/proc/self/cgroup", "2:cpu,cpuacct:/a/b\n0::/c/d\n");
  Write("/sys/fs/cgroup/cpu/a/cpu.cfs_period_us", "100000\n");
  const struct {
    std::string version_1, version_2;
    int cores;
  } rows[] = {{"-1", "max", all},
              {"150000", "max", std::min(all, 2)},
              {"-1", "150000", std::min(all, 2)},
              {"50000", "max", 1},
              {"-1", "50000", 1}};
  for (const auto& row : rows) {
    Write("/sys/fs/cgroup/cpu/a/cpu.cfs_quota_us", row.version_1 + "\n");
    Write("/sys/fs/cgroup/c/cpu.max", row.version_2 + " 100000\n");
    EXPECT_EQ(MachineCores(root_.path()), row.cores) << row.version_1 << " " << row.version_2;
  }
  std::thread([] {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
    EXPECT_EQ(MachineCores(), 1);
  }).join();
}

TEST_F(MachineLimits, KillsAreThoseOfTheOwnGroup) {
  Write("/proc/self/cgroup", "0::/a/b\n");
  Write("/sys/fs/cgroup/a/b/memory.events", "oom 5\noom_kill 2\n");
  Write("/sys/fs/cgroup/a/memory.events", "oom_kill 7\n");
  EXPECT_EQ(ReadOutOfMemoryKills(root_.path()).group, "") << "without the boot's identity";
  Write("/proc/sys/kernel/random/boot_id", "boot\n");
  const OutOfMemoryKills kills = ReadOutOfMemoryKills(root_.path());
  EXPECT_EQ(kills.kills, 2);
  EXPECT_TRUE(kills.group.starts_with("boot "));
}

}  // namespace
}  // namespace ballpiston::server
