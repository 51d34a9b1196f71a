#include "client/web/page_access.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

const PageAccess& Access() {
  static const PageAccess access(8080, "secret");
  return access;
}

TEST(PageAccess, AcceptsItsOwnAddressAndProgramsWithoutAnOrigin) {
  EXPECT_TRUE(Access().CheckOrigin("127.0.0.1:8080", "").ok());
  EXPECT_TRUE(Access().CheckOrigin("localhost:8080", "http://localhost:8080").ok());
  EXPECT_TRUE(Access().CheckOrigin("127.0.0.1:8080", "http://127.0.0.1:8080").ok());
}

TEST(PageAccess, RejectsOtherHosts) {
  for (const char* host : {"", "evil.example", "evil.example:8080", "127.0.0.1", "127.0.0.1:80",
                           "127.0.0.1:8080.evil.example", "127.0.0.1:80800"}) {
    const absl::Status status = Access().CheckOrigin(host, "");
    EXPECT_EQ(status.code(), absl::StatusCode::kPermissionDenied) << host;
    EXPECT_THAT(status.message(), HasSubstr("permitted: 127.0.0.1:8080, localhost:8080"));
  }
}

TEST(PageAccess, RejectsOtherOrigins) {
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1:8080",
                             "http://127.0.0.1:8081", "http://127.0.0.1:8080.evil.example"}) {
    const absl::Status status = Access().CheckOrigin("127.0.0.1:8080", origin);
    EXPECT_EQ(status.code(), absl::StatusCode::kPermissionDenied) << origin;
    EXPECT_THAT(status.message(), HasSubstr(origin));
  }
}

TEST(PageAccess, RequiresItsToken) {
  EXPECT_TRUE(Access().CheckToken("Bearer secret").ok());
  for (const char* header : {"", "secret", "Bearer secreT", "Bearer secret ", "bearer secret",
                             "Bearer ", "Bearer secre"}) {
    const absl::Status status = Access().CheckToken(header);
    EXPECT_EQ(status.code(), absl::StatusCode::kUnauthenticated) << header;
    EXPECT_THAT(status.message(), ::testing::Not(HasSubstr("secret")));
  }
}

TEST(PageAccess, TheTokenIsInTheFragmentOfTheAddress) {
  EXPECT_EQ(Access().Url(), "http://127.0.0.1:8080/#token=secret");
}

}  // namespace
}  // namespace ballpiston::client
