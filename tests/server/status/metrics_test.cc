// The metrics over HTTP.
#include "tests/server/http_get.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

constexpr char kCreated[] =
    "grpc_server_handled_total{grpc_code=\"OK\",grpc_method=\"CreateEnsembleJob\","
    "grpc_service=\"ballpiston.v1.EnsembleService\",grpc_type=\"unary\"}";

constexpr char kReflected[] =
    "grpc_server_handled_total{grpc_code=\"OK\",grpc_method=\"ServerReflectionInfo\","
    "grpc_service=\"grpc.reflection.v1alpha.ServerReflection\",grpc_type=\"bidi_stream\"}";

constexpr char kSample[] =
    R"(^[a-zA-Z_:][a-zA-Z0-9_:]*(\{([a-zA-Z_][a-zA-Z0-9_]*="([^"\\]|\\.)*",?)*\})? [^ ]+$)";

// The values by name with labels. The test fails if a line is not in the text format.
std::map<std::string, double> Samples(const std::string& page) {
  std::map<std::string, double> samples;
  std::istringstream lines(page.substr(page.find("\r\n\r\n") + 4));
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("# HELP ", 0) == 0 || line.rfind("# TYPE ", 0) == 0) continue;
    EXPECT_THAT(line, testing::MatchesRegex(kSample));
    const size_t space = line.rfind(' ');
    const auto inserted =
        samples.emplace(line.substr(0, space), std::strtod(line.c_str() + space, nullptr));
    EXPECT_TRUE(inserted.second) << "twice: " << line;
  }
  return samples;
}

// Each test has several expectations, because the HTTP server of each test takes up to 2 s to stop.
class MetricsTest : public testing::Test {
 protected:
  RunningServer& Start() {
    return server_.emplace(
        TestServerOptions{.limits = {.max_points_per_job = 10}, .metrics_listen = "localhost:0"});
  }
  std::string Address() { return server_->server().metrics_address(); }
  std::string Page() { return HttpGet(Address(), "/metrics"); }
  std::map<std::string, double> Metrics() { return Samples(Page()); }
  // A client sees the end of a job or a stream just before it is counted.
  void Await(const std::string& metric, double value) {
    AwaitThat([&] { return Metrics().at(metric) == value; });
  }

  std::optional<RunningServer> server_;
};

TEST_F(MetricsTest, AFolderThatOthersCanWriteIsAProblemOfTheCluster) {
  const TemporaryFolder shared;
  chmod(shared.path().c_str(), 0777);
  server_.emplace(TestServerOptions{.metrics_listen = "localhost:0",
                                    .cluster = ClusterOptions{.folder = shared.path()}});
  Await("ballpiston_cluster_failing", 1);
  EXPECT_THAT(server_->Status().cluster().problem(), HasSubstr("can be written by other users"));
}

TEST_F(MetricsTest, AHealthWatchEndedByItsClientIsNotLogged) {
  testing::internal::CaptureStderr();
  RunningServer& server = Start();
  {
    NamedCall watch(server.channel(), kWatchHealth);
    watch.Send(kWholeServer);
    watch.AwaitAnswer();
  }
  const auto ended_as = [this](const std::string& code) {
    const auto metrics = Metrics();
    const auto found =
        metrics.find("grpc_server_handled_total{grpc_code=\"" + code +
                     "\",grpc_method=\"Watch\",grpc_service=\"grpc.health.v1.Health\","
                     "grpc_type=\"server_stream\"}");
    return found == metrics.end() ? 0 : found->second;
  };
  AwaitThat([&] { return ended_as("CANCELLED") + ended_as("UNKNOWN") > 0; });
  EXPECT_EQ(ended_as("CANCELLED"), 1);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), testing::Not(HasSubstr("call failed")));
}

TEST_F(MetricsTest, CountersCountCallsJobsAndSamples) {
  RunningServer& server = Start();
  std::string name;
  for (int i = 0; i < 3; ++i) name = server.Succeeded(Equilibrium(2, 50));
  EXPECT_FALSE(server.Call(CreateRequest(Equilibrium(11, 1))).ok());
  EXPECT_OK(CallByName(server.channel(), kReflection, kListServices));
  EXPECT_THAT(CallByName(server.channel(), "/no.such.Service/Method"),
              StatusIs(grpc::StatusCode::UNIMPLEMENTED));
  Await("ballpiston_jobs_ended_total{state=\"succeeded\"}", 3);
  const auto metrics = Metrics();
  EXPECT_THAT(Page(), Not(HasSubstr(name.substr(name.find('/') + 1))));  // no job's id
  EXPECT_THAT(Page(), Not(HasSubstr("no.such")));  // clients could invent any number of methods
  EXPECT_EQ(metrics.at(kCreated), 3);
  EXPECT_EQ(metrics.at(kReflected), 1);
  EXPECT_EQ(metrics.at("ballpiston_limit_refusals_total{reason=\"TOO_MANY_POINTS\"}"), 1);
  EXPECT_EQ(metrics.at("ballpiston_principal_stored_jobs{principal=\"local\"}"), 3);
  EXPECT_GT(metrics.at("ballpiston_principal_stored_bytes{principal=\"local\"}"), 0);
  EXPECT_EQ(metrics.at("ballpiston_samples_computed_total"), 3 * 2 * 50 * kFakeSamplesPerBlock);
  EXPECT_GT(metrics.at("ballpiston_store_bytes"), 4096);
  EXPECT_EQ(metrics.at("ballpiston_store_failing"), 0);
  EXPECT_GT(metrics.at("ballpiston_processor_seconds_total"), 0);
  EXPECT_EQ(metrics.at("grpc_server_handling_seconds_count{grpc_method=\"WatchEnsembleJob\","
                       "grpc_service=\"ballpiston.v1.EnsembleService\",grpc_type="
                       "\"server_stream\"}"),
            3);
}

TEST_F(MetricsTest, MalformedRequestsDoNotStopTheEndpoint) {
  RunningServer& server = Start();
  Connection silent(Address()), slow(Address());
  slow.Send("GET /met");
  for (const std::string& request :
       {std::string("no HTTP at all\r\n\r\n"), "GET /" + std::string(100'000, 'a') + "\r\n\r\n",
        std::string("GET /../../etc/passwd HTTP/1.1\r\n\r\n"),
        std::string("POST /metrics HTTP/1.0\r\nContent-Length: 9\r\n\r\n"),
        std::string(5000, '\0')}) {
    Connection connection(Address());
    connection.Send(request);
    EXPECT_THAT(connection.ReadToTheEnd(), Not(HasSubstr(" 200 "))) << request.substr(0, 40);
  }
  EXPECT_THAT(HttpGet(Address(), "/"), HasSubstr(" 404 "));
  EXPECT_EQ(Metrics().at("ballpiston_workers"), 2);
  server.Shutdown();
  const std::string page = Page();  // of the stopped server
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200 OK"));
  EXPECT_THAT(page, Not(HasSubstr("ballpiston_")));
}

}  // namespace
}  // namespace ballpiston::server
