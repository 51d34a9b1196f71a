#include "server/cluster/shared_folder.h"

#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/files.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

ino_t FileNumber(const std::string& path) {
  struct stat found {};
  EXPECT_EQ(stat(path.c_str(), &found), 0);
  return found.st_ino;
}

class SharedFolderTest : public testing::Test {
 protected:
  SharedFolderTest() {
    std::filesystem::create_directory(path_);
    chmod(path_.c_str(), 0755);
  }

  void ExpectRefused(const std::string& path, const std::string& why) const {
    EXPECT_THAT(
        SharedFolder(path, "me").Prepare(),
        StatusIs(absl::StatusCode::kFailedPrecondition, AllOf(HasSubstr(path), HasSubstr(why))));
  }

  const TemporaryFolder temporary_;
  const std::string path_ = temporary_.File("shared");
  const std::string own_ = path_ + "/me";
  const SharedFolder shared_{path_, "me"};
};

TEST_F(SharedFolderTest, AFolderOfItsOwnIsMade) {
  EXPECT_OK(shared_.Prepare());
  EXPECT_EQ(ModeOf(own_), 0700u);
  EXPECT_OK(shared_.Prepare());
  EXPECT_EQ(shared_.PathOf("bp-me-1"), own_ + "/bp-me-1");
}

TEST_F(SharedFolderTest, ARelativePathIsRefused) { ExpectRefused("shared", "absolute"); }

TEST_F(SharedFolderTest, AMissingFolderIsUnavailable) {
  EXPECT_THAT(SharedFolder(path_ + "/missing", "me").Prepare(),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr(path_ + "/missing")));
}

TEST_F(SharedFolderTest, AFileIsRefused) {
  WriteFile(path_ + "/file", "");
  ExpectRefused(path_ + "/file", "is not a folder");
}

TEST_F(SharedFolderTest, AnotherUsersFolderIsRefused) {
  if (geteuid() != 0) return ExpectRefused("/", "belongs to user 0");
  ASSERT_EQ(chown(path_.c_str(), 65534, 65534), 0);
  ExpectRefused(path_, "belongs to user 65534");
}

TEST_F(SharedFolderTest, AFolderThatOthersCanWriteIsRefusedUntilItIsRepaired) {
  for (const mode_t mode : {0770, 0702, 0777, 01777}) {
    chmod(path_.c_str(), mode);
    ExpectRefused(path_, "can be written by other users");
    EXPECT_FALSE(std::filesystem::exists(own_));
  }
  chmod(path_.c_str(), 0755);
  EXPECT_OK(shared_.Prepare());
}

TEST_F(SharedFolderTest, AnOwnFolderThatOthersCanWriteIsRefused) {
  ASSERT_OK(shared_.Prepare());
  chmod(own_.c_str(), 0770);
  EXPECT_THAT(shared_.Prepare(), StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr(own_)));
}

TEST_F(SharedFolderTest, AFileInThePlaceOfTheOwnFolderIsRefused) {
  WriteFile(own_, "");
  EXPECT_THAT(shared_.Prepare(), StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr(own_)));
}

TEST_F(SharedFolderTest, TheWorkerIsCopiedOnceForEachVersion) {
  ASSERT_OK(shared_.Prepare());
  const std::string program = temporary_.File("program");
  WriteFile(program, "first");
  ASSERT_OK_AND_ASSIGN(const std::string first, shared_.CopyWorker(program));
  EXPECT_EQ(Contents(first), "first");
  EXPECT_EQ(ModeOf(first), 0700u);
  const ino_t file = FileNumber(first);
  EXPECT_THAT(shared_.CopyWorker(program), IsOkAndHolds(first));
  EXPECT_EQ(FileNumber(first), file);
  WriteFile(program, "second");
  ASSERT_OK_AND_ASSIGN(const std::string second, shared_.CopyWorker(program));
  EXPECT_NE(second, first);
  EXPECT_EQ(Contents(second), "second");
  EXPECT_EQ(Contents(first), "first") << "tasks may still use it";
}

TEST_F(SharedFolderTest, ADamagedCopyOfTheWorkerIsReplaced) {
  ASSERT_OK(shared_.Prepare());
  const std::string program = temporary_.File("program");
  WriteFile(program, "a program");
  ASSERT_OK_AND_ASSIGN(const std::string copy, shared_.CopyWorker(program));
  for (const std::string damage : {"", "a prog", "a progran", "a program!"}) {
    WriteFile(copy, damage);
    EXPECT_THAT(shared_.CopyWorker(program), IsOkAndHolds(copy));
    EXPECT_EQ(Contents(copy), "a program");
    EXPECT_EQ(ModeOf(copy), 0700u);
  }
}

TEST_F(SharedFolderTest, AMissingWorkerIsNotFound) {
  ASSERT_OK(shared_.Prepare());
  EXPECT_THAT(shared_.CopyWorker(temporary_.File("missing")),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr(temporary_.File("missing"))));
}

TEST_F(SharedFolderTest, ArraysAreListedByTheirPrefix) {
  ASSERT_OK(shared_.Prepare());
  EXPECT_THAT(shared_.ListArrays("bp-me-"), IsOkAndHolds(IsEmpty()));
  for (const std::string name : {"bp-me-1", "bp-me-2", "bp-you-3"})
    ASSERT_OK(shared_.MakeArray(name));
  WriteFile(shared_.PathOf("bp-me-4"), "not a folder");
  WriteFile(shared_.PathOf("bp-me-1") + "/tasks", "");
  EXPECT_THAT(shared_.ListArrays("bp-me-"),
              IsOkAndHolds(UnorderedElementsAre("bp-me-1", "bp-me-2")));
  shared_.RemoveArray("bp-me-1");
  shared_.RemoveArray("bp-me-none");
  EXPECT_THAT(shared_.ListArrays("bp-me-"), IsOkAndHolds(UnorderedElementsAre("bp-me-2")));
}

TEST_F(SharedFolderTest, AFolderThatDisappearsIsUnavailable) {
  ASSERT_OK(shared_.Prepare());
  std::filesystem::remove_all(path_);
  EXPECT_THAT(shared_.MakeArray("bp-me-1"), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_THAT(shared_.ListArrays("bp-me-"), StatusIs(absl::StatusCode::kUnavailable));
}

// On a file system of its own, which only root can mount.
TEST_F(SharedFolderTest, AFullFolderIsResourceExhausted) {
  if (mount("ballpiston", path_.c_str(), "tmpfs", 0, "size=64k,nr_inodes=8,mode=0700") != 0) {
    GTEST_SKIP() << "may not mount a file system";
  }
  const absl::Cleanup unmount = [&] { umount2(path_.c_str(), MNT_DETACH); };
  ASSERT_OK(shared_.Prepare());
  const std::string program = temporary_.File("program");
  WriteFile(program, std::string(200'000, 'x'));
  EXPECT_THAT(shared_.CopyWorker(program),
              StatusIs(absl::StatusCode::kResourceExhausted, HasSubstr("No space left")));
  absl::Status made;
  for (int i = 0; made.ok() && i < 8; ++i) made = shared_.MakeArray(absl::StrCat("bp-me-", i));
  EXPECT_THAT(made, StatusIs(absl::StatusCode::kResourceExhausted, HasSubstr("No space left")));
  for (int i = 0; i < 8; ++i) shared_.RemoveArray(absl::StrCat("bp-me-", i));
  WriteFile(program, "short");
  EXPECT_OK(shared_.CopyWorker(program));
}

}  // namespace
}  // namespace ballpiston::server
