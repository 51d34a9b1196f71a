// Every metric in the alert rules is one that the server serves. `make test-alerts` tests the
// rules.
#include <regex>

#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

std::set<std::string> MetricsNamedIn(const std::string& rules) {
  static const std::regex name("\\b(ballpiston|grpc_server)_\\w+");
  return {std::sregex_token_iterator(rules.begin(), rules.end(), name),
          std::sregex_token_iterator()};
}

// The metrics whose names are in quotes in the server's code.
std::set<std::string> ServedMetrics() {
  static const std::regex name("\"((ballpiston|grpc_server)_\\w+)\"");
  std::set<std::string> names;
  for (const char* file : {"server/rpc/server_metrics.cc", "server/status/call_observer.cc"}) {
    const std::string code = Contents(SourcePath(file));
    names.insert(std::sregex_token_iterator(code.begin(), code.end(), name, 1),
                 std::sregex_token_iterator());
  }
  return names;
}

TEST(AlertRules, EveryMetricIsServed) {
  const auto named = MetricsNamedIn(Contents(SourcePath("server/prometheus/alerts.yml")));
  EXPECT_THAT(named, Contains("ballpiston_store_failing"));
  EXPECT_THAT(ServedMetrics(), testing::IsSupersetOf(named));
}

}  // namespace
}  // namespace ballpiston::server
