#include "client/output/new_file.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

class NewFileTest : public ::testing::Test {
 protected:
  std::string Path() const { return folder_.path() + "/result.csv"; }

  TemporaryFolder folder_;
};

TEST_F(NewFileTest, AppearsWhenItIsKept) {
  {
    NewFile file("--save", Path());
    file.out() << "whole" << std::flush;
    EXPECT_FALSE(std::filesystem::exists(Path()));
    EXPECT_OK(file.Keep());
  }
  EXPECT_EQ(Contents(Path()), "whole");
}

TEST_F(NewFileTest, WithoutKeepTheOldFileStays) {
  WriteFile(Path(), "old");
  { NewFile("--save", Path()).out() << "half"; }
  EXPECT_EQ(Contents(Path()), "old");
  const std::filesystem::directory_iterator files(folder_.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

TEST_F(NewFileTest, AFullDiskIsAnError) {
  NewFile file("--save", "/dev/full");
  file.out() << "text";
  EXPECT_THAT(file.Keep(), StatusIs(kInvalid, HasSubstr("--save: cannot write /dev/full")));
}

TEST_F(NewFileTest, AMissingFolderIsReportedBeforeTheWork) {
  const std::string path = folder_.path() + "/none/result.csv";
  EXPECT_THAT(CheckNewFile("--save", path), StatusIs(kInvalid, HasSubstr(path)));
  EXPECT_THAT(CheckNewFile("--save", folder_.path()), StatusIs(kInvalid, HasSubstr("folder")));
  EXPECT_OK(CheckNewFile("--save", Path()));
  EXPECT_THAT(NewFile("--save", path).Keep(), StatusIs(kInvalid, HasSubstr("No such file")));
}

}  // namespace
}  // namespace ballpiston::client
