#include "tools/stability/output_file.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::stability {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

class OutputFile : public ::testing::Test {
 protected:
  std::string File(const std::string& name) const { return folder_.File(name); }

  TemporaryFolder folder_;
};

TEST_F(OutputFile, ANewFileHoldsTheText) {
  EXPECT_TRUE(CheckWritable(File("new.md")).ok());
  EXPECT_THAT(NamesIn(folder_.path()), IsEmpty());
  EXPECT_TRUE(WriteWholeFile(File("new.md"), "text\n").ok());
  EXPECT_EQ(Contents(File("new.md")), "text\n");
  EXPECT_THAT(NamesIn(folder_.path()), ElementsAre("new.md"));
}

TEST_F(OutputFile, AnExistingFileIsReplacedAndKeepsItsPermissions) {
  const std::string path = File("old.md");
  WriteFile(path, "an older and longer text\n");
  ASSERT_EQ(chmod(path.c_str(), 0640), 0);
  EXPECT_TRUE(CheckWritable(path).ok());
  EXPECT_EQ(Contents(path), "an older and longer text\n");
  EXPECT_TRUE(WriteWholeFile(path, "text\n").ok());
  EXPECT_EQ(Contents(path), "text\n");
  struct stat now = {};
  ASSERT_EQ(stat(path.c_str(), &now), 0);
  EXPECT_EQ(now.st_mode & 07777, 0640u);
  EXPECT_THAT(NamesIn(folder_.path()), ElementsAre("old.md"));
}

TEST_F(OutputFile, TheFileBehindALinkIsReplaced) {
  WriteFile(File("old.md"), "old\n");
  std::filesystem::create_symlink("old.md", File("link.md"));
  EXPECT_TRUE(WriteWholeFile(File("link.md"), "text\n").ok());
  EXPECT_EQ(Contents(File("old.md")), "text\n");
  EXPECT_TRUE(std::filesystem::is_symlink(File("link.md")));
  EXPECT_THAT(NamesIn(folder_.path()), UnorderedElementsAre("link.md", "old.md"));
}

// Expects that both functions return an error with the path and the reason.
void ExpectRefused(const std::string& path, const std::string& reason) {
  for (const absl::Status& status : {CheckWritable(path), WriteWholeFile(path, "text\n")}) {
    EXPECT_FALSE(status.ok()) << path;
    EXPECT_THAT(std::string(status.message()), HasSubstr(path));
    EXPECT_THAT(std::string(status.message()), HasSubstr(reason));
  }
}

TEST_F(OutputFile, PathsThatCannotBeFilesAreRejected) {
  WriteFile(File("file"), "");
  ExpectRefused(File("missing/new.md"), "there is no folder " + File("missing"));
  ExpectRefused(File("file/new.md"), "there is no folder " + File("file"));
  ExpectRefused(folder_.path(), "not a regular file");
  ASSERT_EQ(mkfifo(File("pipe").c_str(), 0600), 0);  // instead of a device
  ExpectRefused(File("pipe"), "not a regular file");
  ExpectRefused("/proc/new.md", "");  // even root cannot create a file there
}

// Root can write everywhere; therefore the test runs as another user.
class OrdinaryUser {
 public:
  OrdinaryUser() : before_(geteuid()) {
    constexpr uid_t kNobody = 65534;
    if (before_ != 0) return;
    EXPECT_EQ(seteuid(kNobody), 0);
  }
  ~OrdinaryUser() { EXPECT_EQ(seteuid(before_), 0); }
  OrdinaryUser(const OrdinaryUser&) = delete;
  OrdinaryUser& operator=(const OrdinaryUser&) = delete;

 private:
  uid_t before_;
};

TEST_F(OutputFile, AFileWithoutPermissionIsRejected) {
  WriteFile(File("old.md"), "old\n");
  ASSERT_EQ(chmod(File("old.md").c_str(), 0444), 0);
  ASSERT_EQ(chmod(folder_.path().c_str(), 0777), 0);  // the folder permits all, the file does not
  {
    const OrdinaryUser user;
    ExpectRefused(File("old.md"), "Permission denied");
  }
  ASSERT_EQ(chmod(folder_.path().c_str(), 0555), 0);
  {
    const OrdinaryUser user;
    ExpectRefused(File("new.md"), "Permission denied");
  }
  ASSERT_EQ(chmod(folder_.path().c_str(), 0755), 0);
}

// Limits the size of this process's files, as on a disk that becomes full.
class SizeLimit {
 public:
  explicit SizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit = {bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  SizeLimit(const SizeLimit&) = delete;
  SizeLimit& operator=(const SizeLimit&) = delete;

 private:
  sighandler_t handler_;
  rlimit before_ = {};
};

TEST_F(OutputFile, AWriteThatFailsHalfwayLeavesTheOldFile) {
  WriteFile(File("old.md"), "old\n");
  absl::Status status;
  {
    const SizeLimit limit(1000);
    status = WriteWholeFile(File("old.md"), std::string(2000, 'x'));
  }
  EXPECT_THAT(std::string(status.message()), HasSubstr(File("old.md")));
  EXPECT_EQ(Contents(File("old.md")), "old\n");
  EXPECT_THAT(NamesIn(folder_.path()), ElementsAre("old.md"));
}

}  // namespace
}  // namespace ballpiston::stability
