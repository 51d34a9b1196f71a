#include "server/door/access_list.h"

#include "absl/strings/escaping.h"
#include "server/sha256.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

const NamedFile kFile{"access-file", "list"};
const absl::Time kNoon = absl::FromCivil(absl::CivilSecond(2030, 6, 1, 12), absl::UTCTimeZone());

std::string HashText(const std::string& token) {
  return "sha256:" + absl::BytesToHexString(Sha256(token));
}

AccessList ParsedList(const std::string& text) {
  auto list = AccessList::Parse(kFile, text);
  EXPECT_OK(list);
  return *std::move(list);
}

TEST(Sha256, EqualsTheTestVector) {
  EXPECT_EQ(HashText("abc"),
            "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(AccessList, ATokenBelongsToItsPrincipal) {
  const AccessList list =
      ParsedList("# the laboratory\n\ntoken " + HashText("one") + " alice submit\n  token\t" +
                 HashText("two") + " bob@lab.example read # on paper\r\ntoken " +
                 HashText("three") + " root-3 admin 2030-06-02");
  EXPECT_EQ(list.size(), 3u);
  EXPECT_EQ(list.OfToken("one", kNoon)->name, "alice");
  EXPECT_EQ(list.OfToken("one", kNoon)->role, Role::kSubmit);
  EXPECT_EQ(list.OfToken("two", kNoon)->name, "bob@lab.example");
  EXPECT_EQ(list.OfToken("two", kNoon)->role, Role::kRead);
  EXPECT_EQ(list.OfToken("three", kNoon)->role, Role::kAdmin);
}

TEST(AccessList, AnEntryIsRefusedFromItsTimeOfExpiryOn) {
  for (const auto& [text, expiry] :
       {std::pair("2030-06-01T12:00:00Z", kNoon),
        {"2030-06-01T14:00:00.5+02:00", kNoon + absl::Milliseconds(500)},
        {"2030-06-02", kNoon + absl::Hours(12)}}) {
    const AccessList list = ParsedList(absl::StrCat("token ", HashText("one"), " a read ", text));
    EXPECT_OK(list.OfToken("one", expiry - absl::Milliseconds(1))) << text;
    EXPECT_THAT(list.OfToken("one", expiry),
                IsError(absl::StatusCode::kUnauthenticated, "CREDENTIALS_EXPIRED"))
        << text;
  }
}

// A token at every place of a line.
TEST(AccessList, ErrorsNameTheLineAndDoNotQuoteIt) {
  const std::string secret = "hunter2hunter2";
  const std::string good = HashText("one");
  const std::pair<std::string, std::string> cases[] = {
      {secret, "the line of a token"},
      {"token " + secret, "the line of a token"},
      {"token " + secret + " alice read", "sha256: and 64 hexadecimal digits"},
      {"token " + good + "0 alice read", "64 hexadecimal digits"},
      {"token " + good.substr(0, 70) + "g alice read", "64 hexadecimal digits"},
      {secret + " " + good + " alice read", "permitted: token sha256:HEX"},
      {"token " + good + " " + secret + "! read", "a-z"},
      {"token " + good + " local read", "not local"},
      {"token " + good + " " + std::string(65, 'a') + " read", "1 to 64"},
      {"token " + good + " alice " + secret, "read, submit, admin"},
      {"token " + good + " alice READ", "read, submit, admin"},
      {"token " + good + " alice read " + secret, "permitted: 2027-01-31T"},
      {"token " + good + " alice read infinite-future", "2027-01-31"},
      {"token " + good + " alice read 2030-13-01", "2027-01-31"},
      {"token " + good + " alice read 2030-06-01 " + secret, "the line of a token"},
      {"certificate " + secret + " alice read", "the line of a token"},
      {"token " + HashText("first") + " bob admin", "earlier line"}};
  for (const auto& [line, permitted] : cases) {
    EXPECT_THAT(
        AccessList::Parse(kFile, "token " + HashText("first") + " alice read\n" + line + "\n"),
        StatusIs(absl::StatusCode::kInvalidArgument,
                 AllOf(HasSubstr("--access-file=list, line 2: "), HasSubstr(permitted),
                       Not(HasSubstr("hunter2")))));
  }
}

class AccessFile : public ::testing::Test {
 protected:
  std::string Error() const { return std::string(AccessList::Read(file_).status().message()); }

  TemporaryFolder folder_;
  NamedFile file_{"access-file", folder_.File("list")};
};

TEST_F(AccessFile, AFileThatOthersMayReadOrWriteIsRefused) {
  WriteFile(file_.path, "token " + HashText("one") + " alice read\n");
  for (const mode_t mode : {0600u, 0400u, 0640u}) {
    chmod(file_.path.c_str(), mode);
    EXPECT_EQ(Error(), "") << mode;
  }
  for (const mode_t mode : {0604u, 0644u, 0660u, 0620u, 0602u, 0666u, 0777u}) {
    chmod(file_.path.c_str(), mode);
    EXPECT_THAT(Error(), HasSubstr("is open to other users")) << mode;
  }
}

TEST_F(AccessFile, OnlyFilesOfTheServersUserOrRootAreAccepted) {
  struct stat status {};
  status.st_mode = S_IFREG | 0600;
  status.st_uid = 1000;
  EXPECT_OK(CheckKeptPrivate(file_, status, 1000));
  EXPECT_THAT(std::string(CheckKeptPrivate(file_, status, 1001).message()),
              HasSubstr("belongs to user 1000; permitted: this server's user (1001) or root"));
  status.st_uid = 0;
  EXPECT_OK(CheckKeptPrivate(file_, status, 1000));
}

TEST_F(AccessFile, OnlyARegularFileIsRead) {
  EXPECT_THAT(Error(), HasSubstr("cannot be opened"));
  ASSERT_EQ(mkfifo(file_.path.c_str(), 0600), 0);  // would wait for a writer
  EXPECT_EQ(Error(), "--access-file=" + file_.path + ": is not a regular file");
}

}  // namespace
}  // namespace ballpiston::server
