// Power cuts at every write and sync while a store is created. The simulation (tests/simulation)
// cuts the power at random moments of a server's life.

#include "tests/fault/store/power_cut.h"

#include "server/store/schema.h"
#include "server/store/sqlite.h"
#include "tests/fault/store/fault_disk.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

TEST(PowerCut, AnInterruptedCreationIsCompletedAtTheNextStart) {
  FaultDisk disk;
  ASSERT_TRUE(OpenStoreFile(kStorePath).ok());
  const std::vector<DiskOperation> operations = disk.operations();
  ASSERT_GT(operations.size(), 10u);
  for (size_t cut = 0; cut <= operations.size(); ++cut) {
    for (const Survival survival : kSurvivals) {
      FaultDisk left(AfterPowerCut({}, operations, cut, survival, 1));
      const auto database = OpenStoreFile(kStorePath);
      ASSERT_TRUE(database.ok()) << database.status() << " at " << cut;
      EXPECT_EQ((*database)->First<std::string>("PRAGMA integrity_check"), "ok");
      EXPECT_EQ((*database)->Integer("PRAGMA user_version"), kSchemaVersion);
      EXPECT_EQ((*database)->Integer("SELECT count(*) FROM jobs"), 0);
    }
  }
}

}  // namespace
}  // namespace ballpiston::server
