#include "server/worker/checked_file.h"

#include <signal.h>
#include <sys/resource.h>
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
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr FileKind kKind = FileKind::kChunks;

std::string SomePayload() {
  std::string payload;
  for (int i = 0; i < 100; ++i) payload.push_back(static_cast<char>(i * 37));
  return payload;
}

std::string SomeFile() { return FrameOf(kKind, SomePayload()); }

TEST(CheckedFile, ThePayloadComesBack) {
  EXPECT_THAT(PayloadOf(kKind, SomeFile()), IsOkAndHolds(SomePayload()));
  EXPECT_THAT(PayloadOf(kKind, FrameOf(kKind, "")), IsOkAndHolds(""));
  EXPECT_EQ(SomeFile().size(), SomePayload().size() + kFrameBytes);
}

// All other values of every byte: of the header, the payload and the checksum.
TEST(CheckedFile, AChangedByteIsRejected) {
  const std::string good = SomeFile();
  for (size_t at = 0; at < good.size(); ++at) {
    std::string file = good;
    for (int change = 1; change < 256; ++change) {
      file[at] = static_cast<char>(good[at] ^ change);
      ASSERT_FALSE(PayloadOf(kKind, file).ok()) << "byte " << at << " changed by " << change;
    }
  }
}

TEST(CheckedFile, AShorterFileIsRejected) {
  const std::string good = SomeFile();
  for (size_t size = 0; size < good.size(); ++size) {
    ASSERT_THAT(PayloadOf(kKind, good.substr(0, size)),
                StatusIs(absl::StatusCode::kOutOfRange, HasSubstr("truncated")))
        << size;
  }
}

TEST(CheckedFile, ALongerFileIsCorrupted) {
  EXPECT_THAT(PayloadOf(kKind, SomeFile() + "x"), StatusIs(absl::StatusCode::kDataLoss));
}

TEST(CheckedFile, AChangedPayloadIsCorrupted) {
  std::string file = SomeFile();
  file[60] ^= 1;
  EXPECT_THAT(PayloadOf(kKind, file),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("corrupted")));
}

TEST(CheckedFile, AnotherFileIsRefused) {
  EXPECT_THAT(PayloadOf(kKind, "#!/bin/bash\necho this is a script of some length\n"),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("not a file of ballpiston")));
  EXPECT_THAT(PayloadOf(FileKind::kTasks, SomeFile()),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("kind 2; expected: kind 1")));
}

TEST(CheckedFile, ANewerFormatIsRefusedWithBothVersions) {
  std::string file = SomeFile();
  file[8] = 2;
  EXPECT_THAT(PayloadOf(kKind, file),
              StatusIs(absl::StatusCode::kUnimplemented,
                       AllOf(HasSubstr("version 2"), HasSubstr("version 1"))));
}

// ---- in a folder ----

class CheckedFileInFolder : public testing::Test {
 protected:
  absl::Status Write(const std::string& payload = SomePayload()) {
    return WriteCheckedFile(path_, kKind, payload);
  }
  absl::StatusOr<std::string> Read() { return ReadCheckedFile(path_, kKind); }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("some.chunks");
};

TEST_F(CheckedFileInFolder, IsWrittenForThisUserAloneAndReadBack) {
  ASSERT_OK(Write());
  EXPECT_THAT(Read(), IsOkAndHolds(SomePayload()));
  EXPECT_EQ(ModeOf(path_), 0600u);
  EXPECT_THAT(NamesIn(folder_.path()), ElementsAre("some.chunks"));
}

TEST_F(CheckedFileInFolder, TheSameBytesMayBeWrittenAgain) {
  ASSERT_OK(Write());
  EXPECT_OK(Write());
  EXPECT_THAT(NamesIn(folder_.path()), ElementsAre("some.chunks"));
}

TEST_F(CheckedFileInFolder, OtherBytesDoNotReplaceIt) {
  ASSERT_OK(Write());
  EXPECT_THAT(Write("others"), StatusIs(absl::StatusCode::kAlreadyExists, HasSubstr(path_)));
  EXPECT_THAT(Read(), IsOkAndHolds(SomePayload()));
  EXPECT_THAT(NamesIn(folder_.path()), ElementsAre("some.chunks"));
}

TEST_F(CheckedFileInFolder, AMissingFileIsNotFound) {
  EXPECT_THAT(Read(), StatusIs(absl::StatusCode::kNotFound, HasSubstr(path_)));
}

TEST_F(CheckedFileInFolder, ADamagedFileIsRefusedByName) {
  WriteFile(path_, SomeFile().substr(0, 90));
  EXPECT_THAT(Read(), StatusIs(absl::StatusCode::kOutOfRange, HasSubstr(path_)));
}

TEST_F(CheckedFileInFolder, ASymbolicLinkIsRefused) {
  const std::string target = folder_.File("target");
  ASSERT_OK(WriteCheckedFile(target, kKind, SomePayload()));
  ASSERT_EQ(symlink(target.c_str(), path_.c_str()), 0);
  EXPECT_THAT(Read(), StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("symbolic link")));
  EXPECT_THAT(Write(), StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("symbolic link")));
}

TEST_F(CheckedFileInFolder, AFolderOrAPipeIsRefused) {
  EXPECT_THAT(ReadCheckedFile(folder_.path(), kKind),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("regular")));
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  EXPECT_THAT(Read(), StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("regular")));
}

TEST_F(CheckedFileInFolder, AFileOfAnotherUserIsRefused) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a file to another user";
  ASSERT_OK(Write());
  ASSERT_EQ(chown(path_.c_str(), 65534, 65534), 0);
  EXPECT_THAT(Read(), StatusIs(absl::StatusCode::kPermissionDenied, HasSubstr("user 65534")));
}

TEST_F(CheckedFileInFolder, AFileThatIsTooLargeIsRefused) {
  ASSERT_OK(Write());
  ASSERT_EQ(truncate(path_.c_str(), kMaxCheckedFile + 1), 0);
  EXPECT_THAT(Read(), StatusIs(absl::StatusCode::kResourceExhausted, HasSubstr("at most")));
  EXPECT_THAT(WriteCheckedFile(folder_.File("new"), kKind, std::string(kMaxCheckedFile, 'x')),
              StatusIs(absl::StatusCode::kResourceExhausted));
}

TEST_F(CheckedFileInFolder, AMissingFolderIsUnavailable) {
  EXPECT_THAT(WriteCheckedFile(folder_.File("missing/file"), kKind, ""),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("missing/file")));
}

// No file of this process may be longer, for the time of a scope.
class ScopedFileLimit {
 public:
  explicit ScopedFileLimit(rlim_t bytes) : handler_(signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit = {bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~ScopedFileLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    signal(SIGXFSZ, handler_);
  }
  ScopedFileLimit(const ScopedFileLimit&) = delete;
  ScopedFileLimit& operator=(const ScopedFileLimit&) = delete;

 private:
  rlimit old_ = {};
  sighandler_t handler_;
};

TEST_F(CheckedFileInFolder, AFullDiskLeavesNoFile) {
  {
    const ScopedFileLimit limit(20);
    EXPECT_THAT(Write(), StatusIs(absl::StatusCode::kResourceExhausted, HasSubstr(path_)));
  }
  EXPECT_THAT(NamesIn(folder_.path()), IsEmpty());
  EXPECT_OK(Write());
}

}  // namespace
}  // namespace ballpiston::server
