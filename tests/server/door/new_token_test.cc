#include "server/door/new_token.h"

#include "server/door/access_list.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

const absl::Time kIssueTime =
    absl::FromCivil(absl::CivilSecond(2030, 6, 1, 12), absl::UTCTimeZone());

class NewToken : public ::testing::Test {
 protected:
  std::string Issue(const std::string& request) const {
    const auto token = IssueToken(file_, *ParseTokenRequest(request), kIssueTime);
    EXPECT_OK(token);
    return *token;
  }

  TemporaryFolder folder_;
  const NamedFile file_{"access-file", folder_.File("list")};
};

TEST_F(NewToken, AuthenticatesItsPrincipalAndIsNotInTheFile) {
  const std::string token = Issue("alice:submit");
  ASSERT_OK_AND_ASSIGN(const auto list, AccessList::Read(file_));
  EXPECT_EQ(list.OfToken(token, kIssueTime + absl::Hours(24 * 36'500))->name, "alice");
  EXPECT_EQ(list.OfToken(token, kIssueTime)->role, Role::kSubmit);
  EXPECT_THAT(Contents(file_.path), Not(HasSubstr(token)));
  EXPECT_THAT(Contents(file_.path), Not(HasSubstr(token.substr(3))));  // without its prefix
}

TEST_F(NewToken, TheFileIsItsOwnersOnly) {
  const mode_t before = umask(0);
  Issue("alice:read");
  umask(before);
  EXPECT_EQ(ModeOf(file_.path), 0600u);
}

TEST_F(NewToken, ExpiresAfterItsDays) {
  const std::string token = Issue("alice:admin:30");
  const auto list = AccessList::Read(file_);
  EXPECT_OK(list->OfToken(token, kIssueTime + 29.9 * absl::Hours(24)));
  EXPECT_FALSE(list->OfToken(token, kIssueTime + 30 * absl::Hours(24)).ok());
}

TEST_F(NewToken, AnOpenOrMalformedFileStaysUnchanged) {
  WriteFile(file_.path, "");
  chmod(file_.path.c_str(), 0644);
  const TokenRequest request = *ParseTokenRequest("alice:read");
  EXPECT_THAT(std::string(IssueToken(file_, request, kIssueTime).status().message()),
              HasSubstr("open to other users"));
  chmod(file_.path.c_str(), 0600);
  WriteFile(file_.path, "nonsense\n");
  EXPECT_THAT(std::string(IssueToken(file_, request, kIssueTime).status().message()),
              HasSubstr("line 1"));
  EXPECT_EQ(Contents(file_.path), "nonsense\n");
  WriteFile(file_.path, std::string(kMaxSecurityFile - 50, '#'));  // a comment
  EXPECT_THAT(std::string(IssueToken(file_, request, kIssueTime).status().message()),
              HasSubstr("permitted: up to 1048576; remove old"));
  EXPECT_EQ(Contents(file_.path).size(), kMaxSecurityFile - 50);
}

// No file may grow beyond `bytes`, as on a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit = {bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*const handler_)(int) = signal(SIGXFSZ, SIG_IGN);
  rlimit before_{};
};

TEST_F(NewToken, OnAFullDiskTheFileStaysUnchanged) {
  while (!std::filesystem::exists(file_.path) || Contents(file_.path).size() < 900)
    Issue("alice:submit");
  const std::string before = Contents(file_.path);
  {
    const FullDisk disk(before.size() + 20);
    const auto token = IssueToken(file_, *ParseTokenRequest("bob:submit"), kIssueTime);
    EXPECT_THAT(std::string(token.status().message()), HasSubstr("No space left"));
  }
  EXPECT_EQ(Contents(file_.path), before);
  Issue("bob:submit");
}

TEST_F(NewToken, WithoutItsFolderNoFileIsMade) {
  const NamedFile nowhere{"access-file", folder_.File("no/such/list")};
  EXPECT_THAT(IssueToken(nowhere, *ParseTokenRequest("alice:read"), kIssueTime),
              StatusIs(absl::StatusCode::kPermissionDenied));
}

TEST_F(NewToken, MalformedRequestsAreRefused) {
  for (const char* text :
       {"", "alice", "alice:", ":read", "alice:root", "alice:read:", "a b:read", "alice:read:0",
        "alice:read:x", "alice:read:36501", "alice:read:1:2", "local:read"}) {
    const auto request = ParseTokenRequest(text);
    EXPECT_THAT(request, StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("--new-token")))
        << text;
  }
}

}  // namespace
}  // namespace ballpiston::server
