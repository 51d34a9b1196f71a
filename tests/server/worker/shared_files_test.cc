#include "server/worker/shared_files.h"

#include "tests/support/preamble.h"
#include "tests/support/scoped.h"

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
  EXPECT_FALSE(files_.Create("todo/a", "not the first").ok());
  EXPECT_OK(files_.Append("todo/a", " two"));
  EXPECT_THAT(files_.Read("todo/a", 0), IsOkAndHolds("one two"));
  EXPECT_THAT(files_.Read("todo/a", 4), IsOkAndHolds("two"));
  EXPECT_OK(files_.Move("todo/a", "taken/a"));
  EXPECT_OK(files_.Move("todo/a", "taken/a"));  // again, after NFS has lost the first answer
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

TEST_F(FolderFilesTest, AFolderThatIsNotThereCannotBeUsed) {
  EXPECT_THAT(files_.List("done"), StatusIs(Code::kUnavailable, HasSubstr("/done")));
  EXPECT_THAT(files_.Create("done/a", "x"), StatusIs(Code::kUnavailable, HasSubstr("/done/a")));
}

TEST_F(FolderFilesTest, LinksAndPipesAreNotRead) {
  WriteFile(folder_.File("secret"), "secret");
  ASSERT_EQ(symlink("../secret", folder_.File("todo/link").c_str()), 0);
  ASSERT_EQ(mkfifo(folder_.File("todo/pipe").c_str(), 0600), 0);
  EXPECT_THAT(files_.Read("todo/link", 0), StatusIs(Code::kPermissionDenied));
  EXPECT_THAT(files_.Append("todo/link", "x"), StatusIs(Code::kPermissionDenied));
  EXPECT_THAT(files_.Read("todo/pipe", 0), StatusIs(Code::kPermissionDenied));
}

TEST_F(FolderFilesTest, AFullDiskLeavesTheFileAsItWas) {
  ASSERT_OK(files_.Create("todo/a", "one").status());
  const std::string large(2000, 'x');
  absl::Status appended;
  absl::Status created;
  {
    const ScopedLimit full_disk(RLIMIT_FSIZE, 1000);
    appended = files_.Append("todo/a", large);
    created = files_.Create("todo/b", large).status();
  }
  EXPECT_THAT(appended, StatusIs(Code::kResourceExhausted));
  EXPECT_THAT(created, StatusIs(Code::kResourceExhausted));
  EXPECT_THAT(files_.Read("todo/a", 0), IsOkAndHolds("one"));
  EXPECT_THAT(files_.Stamp("todo/b"), StatusIs(Code::kNotFound));
}

}  // namespace
}  // namespace ballpiston::server
