// The store alone on the simulated machine.
#include "server/store/store.h"

#include "tests/fault/store/fault_disk.h"
#include "tests/simulation/machine.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

using std::chrono::seconds;

// A checkpoint that a later one supersedes is settled at once; the earlier record still waits.
TEST(SimulatedStore, AFlushIsNotOkWhileAnEarlierRecordWaits) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Machine machine(seed);
    machine.Run([&] {
      FaultDisk disk;
      const std::unique_ptr<Store> store = *Store::Open(kStorePath, {});
      disk.Refuse(FaultDisk::Refusal::kWriteError, disk.operation_count());
      store->RecordChunk(1, 0, 5, "chunk");
      machine.Sleep(seconds(3));  // it was tried, and waits
      std::optional<absl::Status> flushed;
      Machine::Fiber* const flush = machine.Start([&] { flushed = store->Flush(); });
      for (uint64_t chunk = 1; chunk < 4; ++chunk) {
        machine.Yield();
        store->RecordCheckpoint(1, 0, chunk, [] { return "checkpoint"; });
      }
      machine.Join(flush);
      EXPECT_FALSE(flushed->ok()) << seed;
      disk.StopRefusing();
      EXPECT_OK(store->Flush());
      store->Close();
    });
  }
}

}  // namespace
}  // namespace ballpiston::server
