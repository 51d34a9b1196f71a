// `ballpiston web` and `ballpiston report`: calls as curl and a browser make them, against a real
// server.
#include <httplib.h>

#include "tests/end_to_end/programs.h"
#include "tests/server/http_get.h"

namespace ballpiston {
namespace {

constexpr char kUnary[] = "application/json";
constexpr char kStream[] = "application/connect+json";
constexpr char kJobs[] = "/ballpiston.v1.EnsembleService/";

std::string Envelope(const std::string& json) {
  return std::string(3, '\0') + static_cast<char>(json.size() >> 8) +
         static_cast<char>(json.size()) + json;
}

class WebTest : public ::testing::Test {
 protected:
  WebTest() {
    web_.emplace(server_.Command({"web"}));
    if (!web_->WaitForOut("\n")) throw std::runtime_error(web_->Output());
    const std::string line = web_->Output();
    const std::vector<std::string> parts =
        absl::StrSplit(line.substr(0, line.find('\n')), "/#token=");
    host_ = parts[0];
    address_ = host_.substr(host_.rfind('/') + 1);
    token_ = parts[1];
    http_.emplace(host_);
    http_->set_read_timeout(kPatience);
  }

  // `method`: of the jobs' service, or a whole path.
  httplib::Result Post(const std::string& method, const std::string& body,
                       const httplib::Headers& headers = {}, const char* type = kUnary) {
    httplib::Headers all = headers;
    if (!all.contains("Authorization")) all.emplace("Authorization", "Bearer " + token_);
    return http_->Post(method[0] == '/' ? method : kJobs + method, all, body, type);
  }

  TestServer server_;
  std::optional<Process> web_;
  std::optional<httplib::Client> http_;
  std::string host_;     // http://ADDRESS
  std::string address_;  // ADDRESS
  std::string token_;
};

TEST_F(WebTest, ServesThePageWithSecurityHeaders) {
  const httplib::Result page = http_->Get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_THAT(page->body, HasSubstr("<title>"));
  EXPECT_EQ(page->get_header_value("X-Content-Type-Options"), "nosniff");
  EXPECT_THAT(page->get_header_value("Content-Security-Policy"),
              AllOf(HasSubstr("default-src 'none'"), HasSubstr("frame-ancestors 'none'")));
  EXPECT_EQ(http_->Get("/no-such-file")->status, 404);
  EXPECT_EQ(http_->Get("/..%2f..%2fbin/ballpiston")->status, 404);
}

// A whole job: what the gateway answers is what `--format json` prints.
TEST_F(WebTest, AJobIsSubmittedWatchedAndReadAsByTheClient) {
  const httplib::Result created = Post("CreateEnsembleJob", R"({"spec": {
      "experiment": "FIRST_HIT", "seed": "7", "target": {"samples": "2000"},
      "grid": {"rho": [0.53], "delta": [0.2, 0.1], "epsilon": [0.1], "exponent": [1]}}})");
  ASSERT_EQ(created->status, 200) << created->body;
  EXPECT_EQ(created->get_header_value("Content-Type"), kUnary);
  const std::string name = FromJson<v1::EnsembleJob>(created->body).name();

  const httplib::Result watched =
      Post("WatchEnsembleJob", Envelope(absl::StrCat("{\"name\": \"", name, "\"}")), {}, kStream);
  ASSERT_EQ(watched->status, 200);
  EXPECT_EQ(watched->get_header_value("Content-Type"), kStream);
  EXPECT_THAT(watched->body,
              AllOf(HasSubstr(R"("state":"SUCCEEDED")"), EndsWith(std::string("\2\0\0\0\2{}", 7))));

  const httplib::Result results = Post("ListResults", absl::StrCat("{\"parent\": \"", name, "\"}"));
  const ProcessResult lines = server_.Client({"result", name, "--format", "jsonl"});
  const std::vector<std::string> points = absl::StrSplit(lines.out, '\n', absl::SkipEmpty());
  ASSERT_EQ(points.size(), 2u);
  const auto named = [&](size_t i) {  // the command line leaves the names out
    const std::string unnamed = points[i].substr(0, points[i].size() - 1);
    return absl::StrCat(unnamed, ",\"name\":\"", name, "/results/", i, "\"}");
  };
  EXPECT_EQ(results->body,
            absl::StrCat("{\"results\":[", named(0), ",", named(1), "],\"next_page_token\":\"\"}"));
}

TEST_F(WebTest, ErrorsHaveTheServersCodesReasonsAndViolations) {
  const httplib::Result missing = Post("GetEnsembleJob", R"({"name": "ensembleJobs/none"})");
  EXPECT_EQ(missing->status, 404);
  EXPECT_THAT(missing->body, AllOf(HasSubstr(R"("code":"not_found")"), HasSubstr("JOB_NOT_FOUND")));
  const httplib::Result invalid =
      Post("CreateEnsembleJob", R"({"spec": {"experiment": "EQUILIBRIUM"}})");
  EXPECT_EQ(invalid->status, 400);
  EXPECT_THAT(invalid->body, HasSubstr(R"("field":"spec.grid.rho")"));
  for (const char* body : {"null", "[]", "{\"nme\": 1}", "{", "\xff"}) {
    const httplib::Result bad = Post("GetEnsembleJob", body);
    EXPECT_EQ(bad->status, 400) << body;
    EXPECT_THAT(bad->body, HasSubstr("not JSON of ballpiston.v1.GetEnsembleJobRequest"));
  }
  const httplib::Result stream = Post("WatchEnsembleJob", "{}", {}, kStream);
  EXPECT_EQ(stream->status, 200);
  EXPECT_THAT(stream->body, HasSubstr("in an envelope"));
  EXPECT_EQ(Post("WatchEnsembleJob", "{}")->status, 415);
  EXPECT_EQ(Post("GetEnsembleJob", "{}", {}, "text/plain")->status, 415);
  EXPECT_EQ(Post("/ballpiston.v1.EnsembleService/Nothing", "{}")->status, 404);
  EXPECT_EQ(Post("/ballpiston.v1.EnsembleJob/spec", "{}")->status, 404);
  EXPECT_EQ(Post("GetEnsembleJob", "{}", {{"Connect-Timeout-Ms", "-1"}})->status, 400);
  EXPECT_EQ(Post("GetEnsembleJob", std::string(15 << 20, ' '))->status, 400);
  const httplib::Result long_one = Post("GetEnsembleJob", std::string(17 << 20, ' '));
  EXPECT_EQ(long_one->status, 413);
  EXPECT_THAT(long_one->body, HasSubstr(R"("code":"resource_exhausted")"));
  const httplib::Result no_method =
      http_->Put("/a/b", {{"Authorization", "Bearer " + token_}}, "{}", kUnary);
  EXPECT_EQ(no_method->status, 404);
  EXPECT_THAT(no_method->body, HasSubstr(R"("code":"unimplemented")"));
}

TEST_F(WebTest, CallsNeedTheTokenAndThisPagesOriginAndHost) {
  const auto call = [this](const httplib::Headers& headers) {
    return Post("ListEnsembleJobs", "{}", headers);
  };
  const std::string localhost = "localhost" + address_.substr(address_.find(':'));
  EXPECT_EQ(call({})->status, 200);  // a program that sends no origin
  for (const std::string& host : {address_, localhost}) {
    EXPECT_EQ(call({{"Host", host}, {"Origin", "http://" + host}})->status, 200);
  }
  for (const std::string& authorization :
       {std::string(), token_, "bearer " + token_, "Bearer " + token_.substr(1),
        "Bearer " + token_ + "x", "Bearer " + token_.substr(0, token_.size() - 1) + "!"}) {
    const httplib::Result refused = call({{"Authorization", authorization}});
    EXPECT_EQ(refused->status, 401) << authorization;
    EXPECT_THAT(refused->body, Not(HasSubstr(token_)));
  }
  for (const std::string& origin : {std::string("http://evil.example"), std::string("null"),
                                    "https://" + address_, host_ + ".evil.example"}) {
    const httplib::Result refused = call({{"Origin", origin}});
    EXPECT_EQ(refused->status, 403) << origin;
    EXPECT_THAT(refused->body, HasSubstr(origin));
  }
  for (const std::string& host : {std::string("evil.example"), std::string("127.0.0.1"),
                                  std::string("127.0.0.1:80"), address_ + ".evil.example"}) {
    const httplib::Result refused = call({{"Host", host}});
    EXPECT_EQ(refused->status, 403) << host;
    EXPECT_THAT(refused->body, HasSubstr("permitted: " + address_ + ", " + localhost));
    EXPECT_EQ(http_->Get("/", {{"Host", host}})->status, 403);
  }
}

// The body never arrives. The answer does, and then the connection ends.
TEST_F(WebTest, ARefusedRequestIsAnsweredBeforeItsBodyIsRead) {
  const std::string host = "Host: " + address_ + "\r\n";
  const std::string length = "Content-Length: 9\r\n";
  const std::string token = "Authorization: Bearer " + token_ + "\r\n";
  const std::pair<std::string, int> rows[] = {
      {"Host: evil.example\r\n" + token + length, 403},
      {host + token + length + "Origin: null\r\n", 403},
      {host + length, 401},
      {host + token, 400},
      {host + token + length + "Transfer-Encoding: chunked\r\n", 400},
      {host + token + length + "Content-Encoding: gzip\r\n", 400}};
  for (const std::string method : {"POST", "PUT"}) {
    for (const auto& [headers, status] : rows) {
      server::Connection connection(address_);
      connection.Send(method + " / HTTP/1.1\r\n" + headers + "\r\n");
      EXPECT_THAT(connection.ReadToTheEnd(), StartsWith(absl::StrCat("HTTP/1.1 ", status)));
    }
  }
}

// Streams have their own limit, so the other calls find a thread. When a reader disconnects its
// call ends, so there is room for the next streams.
TEST_F(WebTest, AStreamEndsWhenItsReaderDisconnects) {
  const std::string name = server_.Submit(kEndlessQuestion);
  const auto watch = [&](const std::function<bool()>& goes_on) {
    httplib::Client reader(host_);
    reader.set_read_timeout(kPatience);
    httplib::Request request;
    request.method = "POST";
    request.path = std::string(kJobs) + "WatchEnsembleJob";
    request.headers = {{"Authorization", "Bearer " + token_}, {"Content-Type", kStream}};
    request.body = Envelope(absl::StrCat("{\"name\": \"", name, "\"}"));
    std::string received;
    request.content_receiver = [&](const char* data, size_t size, uint64_t, uint64_t) {
      received.append(data, size);
      return goes_on();
    };
    reader.send(request);
    return received;
  };
  std::atomic<int> open = 0;
  std::atomic<bool> ended = false;
  {
    std::vector<std::jthread> readers;
    for (int i = 0; i < 24; ++i) {
      readers.emplace_back([&] {
        watch([&, is_first = true]() mutable {
          open += std::exchange(is_first, false) ? 1 : 0;
          return !ended;
        });
      });
      // One after the other: the system may drop connections that come together.
      AwaitThat([&] { return open == i + 1; });
    }
    EXPECT_THAT(watch([] { return false; }), HasSubstr(R"("code":"resource_exhausted")"));
    EXPECT_EQ(Post("ListEnsembleJobs", "{}")->status, 200);
    ended = true;
  }
  AwaitThat([&] { return absl::StrContains(watch([] { return false; }), name); });
  EXPECT_THAT(server_.Client({"cancel", name}), ExitsWith(0));
}

TEST(WebErrors, NameAPortInUseAndAMissingProgram) {
  const TestServer server;
  Process web(server.Command({"web"}));
  ASSERT_TRUE(web.WaitForOut("\n"));
  const std::string url = web.Output();
  const std::string port = url.substr(17, url.find("/#") - 17);  // after http://127.0.0.1:
  const ProcessResult taken = server.Client({"web", "--port", port});
  EXPECT_THAT(taken, ExitsWith(2));
  EXPECT_THAT(taken.err, HasSubstr(absl::StrCat("--port ", port, ": the port is in use")));
  web.Signal(SIGINT);
  EXPECT_THAT(web.Wait(), ExitsWith(130));
  fs::copy(ClientProgram(), server.folder().File("alone"));
  const ProcessResult alone = RunProgram({.command = {server.folder().File("alone"), "web"}});
  EXPECT_THAT(alone, ExitsWith(4));
  EXPECT_THAT(alone.err, HasSubstr("/ballpiston-web: No such file"));
}

class ReportTest : public ::testing::Test {
 protected:
  const TestServer server_;
  const std::string file_ = server_.folder().File("report.html");
};

TEST_F(ReportTest, HasJobsWithTheirResultsInOneFile) {
  const std::string first = server_.Submit(kQuickQuestion);
  EXPECT_THAT(server_.Client({"watch", first}), ExitsWith(0));
  const std::string second = server_.Submit(Split("equilibrium --rho 0.53 --delta 0.1"));
  EXPECT_THAT(server_.Client({"watch", second}), ExitsWith(0));
  const ProcessResult result = server_.Client({"report", first, second, "--out", file_});
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.out, file_ + "\n");
  const std::string page = Contents(file_);
  EXPECT_THAT(page, StartsWith("<!doctype html>"));
  EXPECT_THAT(page, Not(HasSubstr(" src=\"")));  // nothing is loaded
  const size_t begin = page.find("{\"job\":");
  const std::vector<std::string> jobs =
      absl::StrSplit(page.substr(begin, page.find("]}</script>", begin) - begin), ",\n{\"job\":");
  ASSERT_EQ(jobs.size(), 2u);
  const auto shown = FromJson<file::v1::SavedResult>(jobs[0]);
  EXPECT_EQ(shown.job().name(), first);
  ASSERT_EQ(shown.points_size(), 2);
  EXPECT_EQ(shown.points().at(0).histograms().at(0).counts_size(), 1000);
  EXPECT_EQ(FromJson<file::v1::SavedResult>("{\"job\":" + jobs[1]).job().name(), second);
}

TEST_F(ReportTest, AFailureKeepsThePreviousFile) {
  WriteFile(file_, "before");
  EXPECT_THAT(server_.Client({"report", "none", "--out", file_}), ExitsWith(5));
  EXPECT_EQ(Contents(file_), "before");
  const std::string job = server_.Submit(Split("equilibrium --rho 0.53 --delta 0.1"));
  EXPECT_THAT(server_.Client({"watch", job}), ExitsWith(0));
  const ProcessResult full = server_.Client({"report", job, "--out", "/dev/full"});
  EXPECT_THAT(full, ExitsWith(2));
  EXPECT_THAT(full.err, HasSubstr("--out: cannot write /dev/full: No space left on device"));
}

}  // namespace
}  // namespace ballpiston
