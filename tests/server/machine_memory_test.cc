#include "server/machine_memory.h"

#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

// A machine whose files of the kernel are in a temporary folder.
class MachineMemoryTest : public testing::Test {
 protected:
  void Write(const std::string& path, const std::string& contents) {
    const std::filesystem::path file = root_.path() + path;
    std::filesystem::create_directories(file.parent_path());
    WriteFile(file, contents);
  }

  const TemporaryFolder root_;
};

TEST_F(MachineMemoryTest, TheLimitOfAGroupThatContainsThisOneCounts) {
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

TEST_F(MachineMemoryTest, ALimitOfVersionOneCounts) {
  Write("/proc/self/cgroup", "5:cpu,memory:/x\n4:memory:/a/b\n");
  Write("/sys/fs/cgroup/memory/a/memory.limit_in_bytes", "3000000\n");
  EXPECT_EQ(MachineMemory(root_.path()), 3e6);
}

TEST_F(MachineMemoryTest, KillsAreThoseOfTheOwnGroup) {
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
