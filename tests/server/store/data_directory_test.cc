#include "server/store/data_directory.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/files.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;

class DataFolder : public ::testing::Test {
 protected:
  void Make(mode_t mode) {
    std::filesystem::create_directory(path_);
    ASSERT_EQ(chmod(path_.c_str(), mode), 0);
  }
  mode_t Mode() const { return ModeOf(path_); }
  static std::string OwnId() { return std::to_string(getpid()) + "\n"; }

  TemporaryFolder folder_;
  const std::string path_ = folder_.File("data");
};

TEST_F(DataFolder, TheLockHasTheServersProcessIdWhileItIsHeld) {
  {
    ASSERT_OK_AND_ASSIGN(const auto directory, DataDirectory::Open(path_));
    EXPECT_EQ(Contents(directory.FilePath("lock")), OwnId());
  }
  EXPECT_EQ(Contents(path_ + "/lock"), "");
}

TEST_F(DataFolder, TheProcessIdOfAKilledServerIsReplaced) {
  Make(0700);
  WriteFile(path_ + "/lock", "123456789012345\n");
  ASSERT_OK_AND_ASSIGN(const auto directory, DataDirectory::Open(path_));
  EXPECT_EQ(Contents(path_ + "/lock"), OwnId());
}

TEST_F(DataFolder, ASecondServerDoesNotChangeTheProcessId) {
  ASSERT_OK_AND_ASSIGN(const auto directory, DataDirectory::Open(path_));
  WriteFile(path_ + "/lock", "12345\n");
  EXPECT_THAT(DataDirectory::Open(path_), StatusIs(absl::StatusCode::kFailedPrecondition));
  EXPECT_EQ(Contents(path_ + "/lock"), "12345\n");
}

TEST_F(DataFolder, AFileOfAnotherProgramNamedLockIsUnchanged) {
  Make(0700);
  for (const std::string text : {"the safe's combination\n", "12345678901234567890123456789012"}) {
    WriteFile(path_ + "/lock", text);
    EXPECT_OK(DataDirectory::Open(path_));
    EXPECT_EQ(Contents(path_ + "/lock"), text);
  }
}

TEST_F(DataFolder, ANewFolderHasMode0700WhateverTheMask) {
  const mode_t before = umask(0);
  EXPECT_OK(DataDirectory::Open(path_));
  umask(before);
  EXPECT_EQ(Mode(), 0700u);
}

TEST_F(DataFolder, AnOpenEmptyFolderIsClosedAndThatIsLogged) {
  for (const mode_t mode : {0755u, 0750u, 0711u, 0777u, 0770u}) {
    Make(mode);
    ::testing::internal::CaptureStderr();
    EXPECT_OK(DataDirectory::Open(path_));
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("is 0700 now"));
    EXPECT_EQ(Mode(), 0700u);
  }
}

TEST_F(DataFolder, AnOpenFolderOfAServerIsClosedWhateverElseIsInIt) {
  for (const char* name : {"lock", "store.sqlite3"}) {
    Make(0755);
    WriteFile(path_ + "/" + name, "");
    WriteFile(path_ + "/notes.txt", "");
    EXPECT_OK(DataDirectory::Open(path_)) << name;
    EXPECT_EQ(Mode(), 0700u) << name;
    std::filesystem::remove_all(path_);
  }
}

// A client that starts a server creates the log file before.
TEST_F(DataFolder, AnOpenFolderWithOnlyAClientsLogIsClosed) {
  Make(0755);
  WriteFile(path_ + "/server.log", "");
  EXPECT_OK(DataDirectory::Open(path_));
  EXPECT_EQ(Mode(), 0700u);
}

// Other users may read these files.
TEST_F(DataFolder, AnOpenFolderWithOtherFilesIsRefusedAndUnchanged) {
  Make(0755);
  WriteFile(path_ + "/thesis.tex", "");
  std::filesystem::create_symlink("/run/lock", path_ + "/lock");  // as in /var
  const auto directory = DataDirectory::Open(path_);
  EXPECT_THAT(directory, StatusIs(absl::StatusCode::kPermissionDenied, HasSubstr("mode 0755")));
  EXPECT_THAT(std::string(directory.status().message()), HasSubstr(path_ + "/ballpiston"));
  EXPECT_EQ(Mode(), 0755u);
}

TEST_F(DataFolder, AClosedFolderWithOtherFilesIsAccepted) {
  Make(0700);
  WriteFile(path_ + "/thesis.tex", "");
  EXPECT_OK(DataDirectory::Open(path_));
}

TEST_F(DataFolder, AClosedFolderIsUnchangedAndNothingIsLogged) {
  Make(0700);
  ::testing::internal::CaptureStderr();
  EXPECT_OK(DataDirectory::Open(path_));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST_F(DataFolder, AFolderOfAllUsersIsRefusedAndUnchanged) {
  Make(01777);
  const auto directory = DataDirectory::Open(path_);
  EXPECT_THAT(directory, StatusIs(absl::StatusCode::kPermissionDenied, HasSubstr("mode 1777")));
  EXPECT_EQ(Mode(), 01777u);
  EXPECT_TRUE(std::filesystem::is_empty(path_));  // not even a lock
}

TEST_F(DataFolder, AnOpenFolderOfAnotherUserIsRefused) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a folder away";
  Make(0755);
  ASSERT_EQ(chown(path_.c_str(), 65534, 65534), 0);
  const auto directory = DataDirectory::Open(path_);
  EXPECT_THAT(directory, StatusIs(absl::StatusCode::kPermissionDenied, HasSubstr("user 65534")));
  EXPECT_EQ(Mode(), 0755u);
}

}  // namespace
}  // namespace ballpiston::server
