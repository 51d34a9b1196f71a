#include "server/store/data_directory.h"

#include <pwd.h>

#include "server/store/folder_sync.h"
#include "tests/support/preamble.h"
#include "tests/support/scoped.h"

namespace ballpiston::server {
namespace {

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
  Make(0700);
  WriteFile(path_ + "/lock", "123456789012345\n");  // of a server that was killed
  WriteFile(path_ + "/server.address", "unix:old\n");
  {
    ASSERT_OK_AND_ASSIGN(const auto directory, DataDirectory::Open(path_));
    EXPECT_EQ(directory.FilePath("lock"), path_ + "/lock");
    EXPECT_EQ(Contents(path_ + "/lock"), OwnId());
    EXPECT_FALSE(std::filesystem::exists(path_ + "/server.address"));
    WriteFile(path_ + "/lock", "12345\n");  // a second server does not change it
    EXPECT_THAT(DataDirectory::Open(path_), StatusIs(absl::StatusCode::kFailedPrecondition));
    EXPECT_EQ(Contents(path_ + "/lock"), "12345\n");
  }
  EXPECT_EQ(Contents(path_ + "/lock"), "");
}

TEST_F(DataFolder, AMovedFolderKeepsItsInodeAndACopyHasAnother) {
  const uint64_t inode = DataDirectory::Open(path_)->Inode();
  std::filesystem::rename(path_, path_ + "-moved");
  std::filesystem::copy(path_ + "-moved", path_);
  EXPECT_EQ(DataDirectory::Open(path_ + "-moved")->Inode(), inode);
  EXPECT_NE(DataDirectory::Open(path_)->Inode(), inode);
}

TEST_F(DataFolder, AFileOfAnotherProgramNamedLockIsUnchanged) {
  Make(0700);
  for (const std::string text : {"the safe's combination\n", "12345678901234567890123456789012"}) {
    WriteFile(path_ + "/lock", text);
    EXPECT_OK(DataDirectory::Open(path_));
    EXPECT_EQ(Contents(path_ + "/lock"), text);
  }
}

TEST(DefaultDataFolder, IsInTheHomeOfTheUsersEntryIfHomeIsNotAnAbsolutePath) {
  const ScopedVariable state("XDG_STATE_HOME"), home("HOME", "relative");
  const passwd* const user = getpwuid(getuid());
  EXPECT_EQ(DataDirectory::Default(),
            absl::StrCat(user == nullptr ? "" : user->pw_dir, "/.local/state/ballpiston"));
}

TEST_F(DataFolder, ANewFolderHasMode0700WhateverTheMask) {
  const mode_t before = umask(0);
  EXPECT_OK(DataDirectory::Open(path_));
  umask(before);
  EXPECT_EQ(Mode(), 0700u);
}

// Which existing folders a server takes: other users may read files of a folder that was open.
TEST_F(DataFolder, AFolderIsClosedIfItIsEmptyOrHasAStore) {
  const struct {
    mode_t mode;
    std::vector<std::string> files;
    mode_t afterwards;
    std::string refusal;
  } rows[] = {{0755, {}, 0700, ""},
              {0711, {}, 0700, ""},
              {0755, {"store.sqlite3", "notes.txt"}, 0700, ""},
              {0755, {"server.log"}, 0700, ""},  // of a client that starts a server
              {0700, {"thesis.tex"}, 0700, ""},
              {0755, {"thesis.tex"}, 0755, "mode 0755"},
              {0770, {"server.log", "thesis.tex"}, 0770, "run chmod 700 " + path_},
              {01777, {}, 01777, "mode 1777"}};
  for (const auto& row : rows) {
    Make(row.mode);
    for (const std::string& name : row.files) WriteFile(path_ + "/" + name, "");
    SCOPED_TRACE(testing::PrintToString(row.files));
    ::testing::internal::CaptureStderr();
    const auto directory = DataDirectory::Open(path_);
    const std::string log = ::testing::internal::GetCapturedStderr();
    EXPECT_EQ(Mode(), row.afterwards);
    EXPECT_EQ(log.find("sets its mode to 0700") != log.npos, row.mode != row.afterwards);
    if (row.refusal.empty()) {
      EXPECT_OK(directory);
    } else {
      EXPECT_THAT(directory, StatusIs(absl::StatusCode::kPermissionDenied,
                                      AllOf(HasSubstr(row.refusal), HasSubstr(path_))));
      EXPECT_FALSE(std::filesystem::exists(path_ + "/lock"));
    }
    std::filesystem::remove_all(path_);
  }
}

TEST_F(DataFolder, AFileInItsPlaceIsRefused) {
  WriteFile(path_, "x");
  for (const std::string& path : {path_, path_ + "/below"}) {
    EXPECT_THAT(DataDirectory::Open(path), StatusIs(absl::StatusCode::kPermissionDenied));
  }
  std::filesystem::remove(path_);
  std::filesystem::create_symlink("nowhere", path_);  // stat and mkdir fail for different reasons
  EXPECT_THAT(DataDirectory::Open(path_),
              StatusIs(absl::StatusCode::kPermissionDenied, HasSubstr("File exists")));
}

TEST_F(DataFolder, AFolderOfAnotherUserIsRefused) {
  for (const mode_t mode : {0755u, 0700u}) {
    Make(mode);
    const bool is_given = geteuid() != 65534 && chown(path_.c_str(), 65534, 65534) == 0;
    if (!is_given) GTEST_SKIP() << "only root can give a folder away";
    EXPECT_THAT(DataDirectory::Open(path_),
                StatusIs(absl::StatusCode::kPermissionDenied, HasSubstr("another user (65534)")));
    EXPECT_EQ(Mode(), mode);
  }
}

TEST(SyncNameOf, FlushesTheFolderThatHasTheName) {
  EXPECT_OK(SyncNameOf("data"));
  EXPECT_OK(SyncNameOf("/data"));
  // When no file can be opened, the error names the folder.
  const ScopedLimit no_file(RLIMIT_NOFILE, 0);
  const std::pair<const char*, const char*> rows[] = {
      {"data", "."}, {"/data", "/"}, {"folder/data", "folder"}, {"/a/b/data", "/a/b"}};
  for (const auto& [path, folder] : rows) {
    EXPECT_THAT(SyncNameOf(path), StatusIs(absl::StatusCode::kUnavailable,
                                           HasSubstr(absl::StrCat("folder ", folder, " cannot"))));
  }
}

}  // namespace
}  // namespace ballpiston::server
