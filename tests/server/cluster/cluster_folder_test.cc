#include "server/cluster/cluster_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/files.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;
using Code = absl::StatusCode;

class ClusterFolderTest : public testing::Test {
 protected:
  ClusterFolderTest() { mkdir(shared_.c_str(), 0700); }

  const TemporaryFolder folder_;
  const std::string shared_ = folder_.File("shared");
};

TEST_F(ClusterFolderTest, HasASubfolderForEachState) {
  EXPECT_OK(PrepareFolder(shared_, "me"));
  EXPECT_OK(PrepareFolder(shared_, "me"));
  EXPECT_THAT(NamesIn(shared_), UnorderedElementsAre("done", "log", "owner", "taken", "todo"));
  EXPECT_EQ(ModeOf(shared_ + "/todo"), 0700u);
}

TEST_F(ClusterFolderTest, AFolderOfAnotherServerIsRefused) {
  EXPECT_OK(PrepareFolder(shared_, "first"));
  EXPECT_THAT(PrepareFolder(shared_, "second"),
              StatusIs(Code::kFailedPrecondition,
                       AllOf(HasSubstr("in use by another server (first"), HasSubstr("owner"))));
  EXPECT_OK(PrepareFolder(shared_, "first"));
}

TEST_F(ClusterFolderTest, AFolderThatOthersCanWriteIsRefused) {
  for (const mode_t mode : {0720, 0702, 01777}) {
    chmod(shared_.c_str(), mode);
    EXPECT_THAT(PrepareFolder(shared_, "me"),
                StatusIs(Code::kFailedPrecondition, HasSubstr("can be written by other users")));
  }
}

TEST_F(ClusterFolderTest, ASubfolderThatOthersCanWriteIsRefused) {
  EXPECT_OK(PrepareFolder(shared_, "me"));
  chmod((shared_ + "/done").c_str(), 0770);
  EXPECT_THAT(PrepareFolder(shared_, "me"),
              StatusIs(Code::kFailedPrecondition, HasSubstr("/done can be written")));
}

TEST_F(ClusterFolderTest, OtherPathsAreRefused) {
  EXPECT_THAT(PrepareFolder("relative", "me"),
              StatusIs(Code::kFailedPrecondition, HasSubstr("not an absolute path")));
  EXPECT_THAT(PrepareFolder(folder_.File("missing"), "me"),
              StatusIs(Code::kUnavailable, HasSubstr("missing")));
  WriteFile(folder_.File("file"), "");
  EXPECT_THAT(PrepareFolder(folder_.File("file"), "me"),
              StatusIs(Code::kFailedPrecondition, HasSubstr("not a folder")));
}

TEST_F(ClusterFolderTest, TheWorkerIsCopiedIfItHasChanged) {
  const std::string program = folder_.File("program"), copy = shared_ + "/ballpiston-worker";
  WriteFile(program, "one");
  EXPECT_OK(CopyWorker(shared_, program));
  EXPECT_EQ(Contents(copy), "one");
  EXPECT_EQ(ModeOf(copy), 0700u);
  struct stat first = {}, second = {};
  stat(copy.c_str(), &first);
  EXPECT_OK(CopyWorker(shared_, program));
  stat(copy.c_str(), &second);
  EXPECT_EQ(first.st_ino, second.st_ino);
  WriteFile(program, "two");
  EXPECT_OK(CopyWorker(shared_, program));
  EXPECT_EQ(Contents(copy), "two");
  EXPECT_THAT(CopyWorker(shared_, folder_.File("missing")), StatusIs(Code::kNotFound));
}

}  // namespace
}  // namespace ballpiston::server
