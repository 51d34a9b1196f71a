#include "server/cluster/cluster_folder.h"

#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

using Code = absl::StatusCode;

class ClusterFolderTest : public testing::Test {
 protected:
  ClusterFolderTest() { mkdir(shared_.c_str(), 0700); }

  const TemporaryFolder folder_;
  const std::string shared_ = folder_.File("shared");
};

TEST_F(ClusterFolderTest, HasASubfolderForEachState) {
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

TEST_F(ClusterFolderTest, OtherFoldersAreRefused) {
  EXPECT_OK(PrepareFolder(shared_, "me"));
  WriteFile(folder_.File("file"), "");
  const struct {
    std::string path;
    std::string changed;  // gets this mode
    mode_t mode;
    Code code;
    const char* why;
  } rows[] = {{shared_, shared_, 0720, Code::kFailedPrecondition, "can be written by other users"},
              {shared_, shared_, 0702, Code::kFailedPrecondition, "can be written by other users"},
              {shared_, shared_, 01777, Code::kFailedPrecondition, "can be written by other users"},
              {shared_, shared_ + "/done", 0770, Code::kFailedPrecondition, "/done can be written"},
              {"relative", shared_, 0700, Code::kFailedPrecondition, "not an absolute path"},
              {folder_.File("missing"), shared_, 0700, Code::kUnavailable, "missing"},
              {folder_.File("file"), shared_, 0700, Code::kFailedPrecondition, "not a folder"}};
  for (const auto& [path, changed, mode, code, why] : rows) {
    chmod(shared_.c_str(), 0700);
    chmod(changed.c_str(), mode);
    EXPECT_THAT(PrepareFolder(path, "me"), StatusIs(code, HasSubstr(why)));
  }
}

TEST_F(ClusterFolderTest, TheWorkerIsCopiedIfItHasChanged) {
  const std::string program = folder_.File("program"), copy = shared_ + "/ballpiston-worker";
  WriteFile(program, "one");
  WriteFile(copy + ".new", "of a server that was killed");
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
  EXPECT_FALSE(std::filesystem::exists(copy + ".new"));
  for (const std::string& unreadable : {folder_.File("missing"), folder_.path()}) {
    EXPECT_THAT(CopyWorker(shared_, unreadable), StatusIs(Code::kNotFound));
  }
}

}  // namespace
}  // namespace ballpiston::server
