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

// The protocol's table of codes. The protocol writes `canceled`, gRPC `CANCELLED`.
TEST(ConnectProtocol, CodesHaveTheProtocolsStatusesAndNames) {
  using Code = absl::StatusCode;
  const std::map<int, std::vector<Code>> table = {
      {400, {Code::kInvalidArgument, Code::kFailedPrecondition, Code::kOutOfRange}},
      {401, {Code::kUnauthenticated}},
      {403, {Code::kPermissionDenied}},
      {404, {Code::kNotFound}},
      {409, {Code::kAlreadyExists, Code::kAborted}},
      {429, {Code::kResourceExhausted}},
      {499, {Code::kCancelled}},
      {500, {Code::kUnknown, Code::kInternal, Code::kDataLoss}},
      {501, {Code::kUnimplemented}},
      {503, {Code::kUnavailable}},
      {504, {Code::kDeadlineExceeded}}};
  for (const auto& [http, codes] : table) {
    for (const Code code : codes) EXPECT_EQ(HttpStatus(code), http) << code;
  }
  EXPECT_THAT(ErrorJson(absl::CancelledError("m")), HasSubstr(R"("code":"canceled")"));
  EXPECT_THAT(ErrorJson(absl::DeadlineExceededError("m")),
              HasSubstr(R"("code":"deadline_exceeded")"));
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
