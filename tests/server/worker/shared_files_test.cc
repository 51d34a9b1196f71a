#include "server/worker/shared_files.h"

#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

using Code = absl::StatusCode;

class FolderFilesTest : public testing::Test {
 protected:
  FolderFilesTest() {
    for (const char* name : {"todo", "taken"}) mkdir(folder_.File(name).c_str(), 0700);
  }

  const TemporaryFolder folder_;
  FolderFiles files_ = FolderFiles(folder_.path());
};

TEST_F(FolderFilesTest, AFileIsMadeReadExtendedMovedAndRemoved) {
  ASSERT_OK_AND_ASSIGN(const FileStamp made, files_.Create("todo/a", "one"));
  EXPECT_EQ(made.bytes, 3u);
  EXPECT_THAT(files_.Stamp("todo/a"), IsOkAndHolds(made));
  EXPECT_OK(files_.Append("todo/a", " two"));
  EXPECT_THAT(files_.Read("todo/a", 0), IsOkAndHolds("one two"));
  EXPECT_THAT(files_.Read("todo/a", 4), IsOkAndHolds("two"));
  EXPECT_OK(files_.Move("todo/a", "taken/a"));
  EXPECT_THAT(files_.List("taken"), IsOkAndHolds(UnorderedElementsAre("a")));
  EXPECT_THAT(files_.List("todo"), IsOkAndHolds(testing::IsEmpty()));
  EXPECT_OK(files_.Remove("taken/a"));
}

TEST_F(FolderFilesTest, AFileThatIsNotThereIsNotFound) {
  EXPECT_THAT(files_.Read("todo/a", 0), StatusIs(Code::kNotFound));
  EXPECT_THAT(files_.Append("todo/a", "x"), StatusIs(Code::kNotFound));
  EXPECT_THAT(files_.Move("todo/a", "taken/a"), StatusIs(Code::kNotFound));
  EXPECT_THAT(files_.Touch("todo/a"), StatusIs(Code::kNotFound));
  EXPECT_THAT(files_.Stamp("todo/a"), StatusIs(Code::kNotFound));
  EXPECT_THAT(files_.Remove("todo/a"), StatusIs(Code::kNotFound));
}

// The second of two requests, of which NFS has lost the first answer.
TEST_F(FolderFilesTest, AMoveThatHasHappenedAlreadySucceeds) {
  ASSERT_OK(files_.Create("taken/a", "one").status());
  EXPECT_OK(files_.Move("todo/a", "taken/a"));
}

TEST_F(FolderFilesTest, AFolderThatIsNotThereCannotBeUsed) {
  EXPECT_THAT(files_.List("done"), StatusIs(Code::kUnavailable, HasSubstr("/done")));
  EXPECT_THAT(files_.Create("done/a", "x"), StatusIs(Code::kUnavailable, HasSubstr("/done/a")));
}

TEST_F(FolderFilesTest, AnExistingFileIsNotReplaced) {
  WriteFile(folder_.File("todo/a"), "old");
  EXPECT_FALSE(files_.Create("todo/a", "new").ok());
  EXPECT_THAT(files_.Read("todo/a", 0), IsOkAndHolds("old"));
}

TEST_F(FolderFilesTest, LinksAndPipesAreNotRead) {
  WriteFile(folder_.File("secret"), "secret");
  ASSERT_EQ(symlink("../secret", folder_.File("todo/link").c_str()), 0);
  ASSERT_EQ(mkfifo(folder_.File("todo/pipe").c_str(), 0600), 0);
  EXPECT_THAT(files_.Read("todo/link", 0), StatusIs(Code::kPermissionDenied));
  EXPECT_THAT(files_.Append("todo/link", "x"), StatusIs(Code::kPermissionDenied));
  EXPECT_THAT(files_.Read("todo/pipe", 0), StatusIs(Code::kPermissionDenied));
}

// A limit of the process has the effect of a full disk.
TEST_F(FolderFilesTest, AFullDiskLeavesTheFileAsItWas) {
  ASSERT_OK(files_.Create("todo/a", "one").status());
  rlimit before = {};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto ignored = signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 1000;
  setrlimit(RLIMIT_FSIZE, &small);
  const absl::Status appended = files_.Append("todo/a", std::string(2000, 'x'));
  const absl::Status created = files_.Create("todo/b", std::string(2000, 'x')).status();
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, ignored);
  EXPECT_THAT(appended, StatusIs(Code::kResourceExhausted));
  EXPECT_THAT(created, StatusIs(Code::kResourceExhausted));
  EXPECT_THAT(files_.Read("todo/a", 0), IsOkAndHolds("one"));
  EXPECT_THAT(files_.Stamp("todo/b"), StatusIs(Code::kNotFound));
}

}  // namespace
}  // namespace ballpiston::server
