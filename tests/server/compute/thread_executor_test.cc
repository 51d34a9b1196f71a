#include "server/compute/thread_executor.h"

#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include "gtest/gtest.h"
#include "tests/server/compute/recording_journal.h"
#include "tests/server/compute/run_requests.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

class JournalThatWaits : public RecordingJournal {
 public:
  explicit JournalThatWaits(std::function<void()> wait) : wait_(std::move(wait)) {}
  void AwaitRoom() override { wait_(); }

 private:
  const std::function<void()> wait_;
};

// What the next process finds if the kernel kills this one during a block, and during a wait for
// the disk.
TEST(ThreadExecutor, ARunIsInTheRecordOnlyWhileItIsComputed) {
  const OutOfMemoryKills before = {"group", 7}, after = {"group", 8};
  const TemporaryFolder folder, in_a_block, in_a_wait;
  const auto keep = [&](const TemporaryFolder& copy) {
    std::filesystem::copy_file(folder.File("computing"), copy.File("computing"),
                               std::filesystem::copy_options::overwrite_existing);
  };
  FactoryOpener opener(
      FakeExperiments([&](size_t, uint64_t, std::stop_token) { keep(in_a_block); }));
  Scheduler scheduler(opener, 1);
  ThreadExecutor threads(scheduler, 1, std::numeric_limits<double>::infinity(),
                         std::make_shared<CrashRecord>(folder.path(), before));
  const auto journal = std::make_shared<JournalThatWaits>([&] { keep(in_a_wait); });
  scheduler.Add(RunOf(1, FakeSpec(1, 3), journal));
  threads.Start();
  EXPECT_OK(journal->AwaitEnd());
  scheduler.Shutdown();
  EXPECT_EQ(CrashRecord(in_a_block.path(), after).Deaths({1, 0}), 1);
  EXPECT_EQ(CrashRecord(in_a_wait.path(), after).Deaths({1, 0}), 0);
}

}  // namespace
}  // namespace ballpiston::server
