#include "server/door/new_token.h"

#include "server/door/access_list.h"
#include "tests/support/preamble.h"
#include "tests/support/scoped.h"

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
  std::string Error(const std::string& request) const {
    return std::string(
        IssueToken(file_, *ParseTokenRequest(request), kIssueTime).status().message());
  }

  TemporaryFolder folder_;
  const NamedFile file_{"access-file", folder_.File("list")};
};

// tests/end_to_end/security_test.cc tests that the token is not in the file.
TEST_F(NewToken, AuthenticatesItsPrincipalAndExpiresAfterItsDays) {
  const mode_t before = umask(0);
  const std::string token = Issue("alice:submit");
  const std::string short_lived = Issue("bob:admin:30");
  umask(before);
  EXPECT_EQ(ModeOf(file_.path), 0600u);
  ASSERT_OK_AND_ASSIGN(const auto list, AccessList::Read(file_));
  const absl::Duration day = absl::Hours(24);
  EXPECT_EQ(list.OfToken(token, kIssueTime + 36'500 * day)->name, "alice");
  EXPECT_EQ(list.OfToken(token, kIssueTime)->role, Role::kSubmit);
  EXPECT_EQ(list.OfToken(short_lived, kIssueTime + 29.9 * day)->role, Role::kAdmin);
  EXPECT_FALSE(list.OfToken(short_lived, kIssueTime + 30 * day).ok());
}

TEST_F(NewToken, AnOpenOrMalformedFileStaysUnchanged) {
  const struct {
    std::string text;
    mode_t mode;
    const char* error;
  } rows[] = {
      {"", 0644, "open to other users"},
      {"nonsense\n", 0600, "line 1"},
      // A comment.
      {std::string(kMaxSecurityFile - 50, '#'), 0600, "permitted: up to 1048576; remove old"}};
  for (const auto& [text, mode, error] : rows) {
    WriteFile(file_.path, text);
    chmod(file_.path.c_str(), mode);
    EXPECT_THAT(Error("alice:read"), HasSubstr(error));
    EXPECT_EQ(Contents(file_.path), text);
  }
}

TEST_F(NewToken, OnAFullDiskTheFileStaysUnchanged) {
  while (!std::filesystem::exists(file_.path) || Contents(file_.path).size() < 900)
    Issue("alice:submit");
  const std::string before = Contents(file_.path);
  {
    const ScopedLimit full_disk(RLIMIT_FSIZE, before.size() + 20);
    EXPECT_THAT(Error("bob:submit"), HasSubstr("No space left"));
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
