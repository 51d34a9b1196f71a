// The model of a power cut, and cuts at every write and sync while a store is created. The
// simulation (tests/simulation) cuts the power at random moments of a server's life.

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

// ---- the model of the disk itself ----

DiskOperation Write(int64_t offset, const std::string& data) {
  return {.path = "f", .file = 0, .offset = offset, .data = data};
}

DiskOperation Sync(bool refused = false) {
  return {.kind = DiskOperation::Kind::kSync, .path = "f", .file = 0, .refused = refused};
}

TEST(PowerCutModel, SyncedDataStaysAndOtherDataMayBeLost) {
  const std::vector<DiskOperation> operations = {Write(0, "ab"), Sync(), Write(1, "X")};
  const DiskFiles initial = {{"f", "...."}};
  EXPECT_EQ(AfterPowerCut(initial, operations, 3, Survival::kNothing, 0).at("f"), "ab..");
  EXPECT_EQ(AfterPowerCut(initial, operations, 3, Survival::kEverything, 0).at("f"), "aX..");
}

TEST(PowerCutModel, ASyncInProgressGuaranteesNothing) {
  const std::vector<DiskOperation> operations = {Write(0, "ab"), Sync()};
  EXPECT_EQ(AfterPowerCut({{"f", ".."}}, operations, 1, Survival::kNothing, 0).at("f"), "..");
}

TEST(PowerCutModel, AfterAFailedSyncALaterOneDoesNotMakeItSafe) {
  const std::vector<DiskOperation> operations = {Write(0, "a"), Sync(true), Write(1, "b"), Sync()};
  EXPECT_EQ(AfterPowerCut({{"f", ".."}}, operations, 4, Survival::kNothing, 0).at("f"), ".b");
}

TEST(PowerCutModel, ANameIsSafeWhenItsFolderWasFlushed) {
  DiskOperation create = {.kind = DiskOperation::Kind::kCreate, .path = "g", .file = 1};
  DiskOperation sync = {.kind = DiskOperation::Kind::kSync, .path = "g", .file = 1};
  EXPECT_THAT(AfterPowerCut({}, {create, sync}, 2, Survival::kNothing, 0), IsEmpty());
  sync.folder = true;
  EXPECT_THAT(AfterPowerCut({}, {create, sync}, 2, Survival::kNothing, 0), Not(IsEmpty()));
}

TEST(PowerCutModel, ASectorIsOldOrNewOrTorn) {
  const std::string before(4096, 'o');
  const std::vector<DiskOperation> operations = {Write(0, std::string(4096, 'n'))};
  int mixed = 0;
  int torn = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto left = [&](Survival survival) {
      return AfterPowerCut({{"f", before}}, operations, 1, survival, seed).at("f");
    };
    const std::string sectors = left(Survival::kSectors);
    for (size_t i = 0; i < 4096; i += 512) EXPECT_EQ(sectors[i], sectors[i + 511]);
    mixed += sectors.find('o') != std::string::npos && sectors.find('n') != std::string::npos;
    const std::string halves = left(Survival::kTornSectors);
    for (size_t i = 0; i < 4096; i += 512) torn += halves[i] != halves[i + 511] ? 1 : 0;
  }
  EXPECT_GT(mixed, 10);
  EXPECT_GT(torn, 5);
}

}  // namespace
}  // namespace ballpiston::server
