// The parts of `ballpiston web` and of the report. tests/end_to_end/web_test.cc tests the whole.
#include "absl/strings/cord.h"
#include "client/output/page_files.h"
#include "client/web/connect_protocol.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// ---- connect_protocol.h ----

TEST(ConnectProtocol, EnvelopesHaveFlagsAndABigEndianLength) {
  EXPECT_EQ(Envelope("{}"), std::string("\0\0\0\0\2{}", 7));
  const std::string long_message(0x10203, 'x');
  EXPECT_EQ(Envelope(long_message).substr(0, 5), std::string("\0\0\1\2\3", 5));
}

TEST(ConnectProtocol, OpensOneWholeEnvelope) {
  EXPECT_EQ(*OpenEnvelope(Envelope("{\"name\": 1}")), "{\"name\": 1}");
  EXPECT_EQ(*OpenEnvelope(Envelope("")), "");
  for (const std::string& body :
       {std::string(), std::string("{}"), std::string("\0\0\0\0\3{}", 7),
        std::string("\1\0\0\0\2{}", 7), Envelope("{}") + "x", Envelope("{}") + Envelope("{}")}) {
    EXPECT_EQ(OpenEnvelope(body).status().code(), absl::StatusCode::kInvalidArgument) << body;
  }
}

// The protocol's table of codes: name and HTTP status.
TEST(ConnectProtocol, CodesHaveTheProtocolsNamesAndStatuses) {
  const struct {
    absl::StatusCode code;
    const char* name;
    int http;
  } kCodes[] = {{absl::StatusCode::kCancelled, "canceled", 499},
                {absl::StatusCode::kUnknown, "unknown", 500},
                {absl::StatusCode::kInvalidArgument, "invalid_argument", 400},
                {absl::StatusCode::kDeadlineExceeded, "deadline_exceeded", 504},
                {absl::StatusCode::kNotFound, "not_found", 404},
                {absl::StatusCode::kAlreadyExists, "already_exists", 409},
                {absl::StatusCode::kPermissionDenied, "permission_denied", 403},
                {absl::StatusCode::kResourceExhausted, "resource_exhausted", 429},
                {absl::StatusCode::kFailedPrecondition, "failed_precondition", 400},
                {absl::StatusCode::kAborted, "aborted", 409},
                {absl::StatusCode::kOutOfRange, "out_of_range", 400},
                {absl::StatusCode::kUnimplemented, "unimplemented", 501},
                {absl::StatusCode::kInternal, "internal", 500},
                {absl::StatusCode::kUnavailable, "unavailable", 503},
                {absl::StatusCode::kDataLoss, "data_loss", 500},
                {absl::StatusCode::kUnauthenticated, "unauthenticated", 401}};
  for (const auto& row : kCodes) {
    EXPECT_EQ(HttpStatus(row.code), row.http) << row.name;
    EXPECT_THAT(ErrorJson(absl::Status(row.code, "m")),
                HasSubstr(std::string("\"code\":\"") + row.name + "\""));
  }
}

TEST(ConnectProtocol, ErrorDetailsAreGivenInBase64AndAsJson) {
  google::rpc::ErrorInfo info;
  info.set_reason("TOO_MANY_JOBS");
  google::rpc::Status attached;
  attached.add_details()->PackFrom(info);
  absl::Status status = absl::ResourceExhaustedError("full");
  status.SetPayload(kStatusPayload, absl::Cord(attached.SerializeAsString()));
  // The bytes 0a 0d "TOO_MANY_JOBS".
  EXPECT_THAT(ErrorJson(status), AllOf(HasSubstr(R"("type":"google.rpc.ErrorInfo")"),
                                       HasSubstr(R"("value":"Cg1UT09fTUFOWV9KT0JT")"),
                                       HasSubstr(R"("reason":"TOO_MANY_JOBS")")));
}

// ---- page_files.h ----

std::map<std::string, PageFile> Files() {
  return {{"page.html",
           {"text/html",
            "<head><link rel=\"stylesheet\" href=\"a.css\">\n"
            "<link rel=\"stylesheet\" href=\"b.css\"></head>"
            "<body><!-- data --><script src=\"c.js\" defer></script></body>"}},
          {"a.css", {"text/css", "a{}\n"}},
          {"b.css", {"text/css", "b{}\n"}},
          {"c.js", {"text/javascript", "c();\n"}}};
}

TEST(OneFilePage, HasItsFilesInTheirPlacesAndItsDataInsideTheirScript) {
  EXPECT_EQ(*OneFilePage(Files(), "page.html", R"({"x":"</script><!--<b>"})"),
            "<head><style>\na{}\n</style>\n<style>\nb{}\n</style></head>"
            "<body><script type=\"application/json\" id=\"data\">"
            R"({"x":"\u003c/script>\u003c!--\u003cb>"})"
            "</script><script>\nc();\n</script></body>");
}

TEST(OneFilePage, NamesAMissingFile) {
  auto files = Files();
  files.erase("b.css");
  EXPECT_THAT(OneFilePage(files, "page.html", "{}").status().message(), HasSubstr("b.css"));
  EXPECT_EQ(OneFilePage(files, "no.html", "{}").status().code(),
            absl::StatusCode::kFailedPrecondition);
}

}  // namespace
}  // namespace ballpiston::client
