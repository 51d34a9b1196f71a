#include "server/api/client_version.h"

#include <optional>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

// The numbers whose change breaks clients: major, and before 1.0.0 minor.
struct Series {
  int major = 0;
  int minor = 0;

  friend bool operator==(const Series&, const Series&) = default;
  std::string Text() const { return major > 0 ? absl::StrCat(major) : absl::StrCat("0.", minor); }
};

std::optional<Series> SeriesOf(absl::string_view version) {
  const std::vector<absl::string_view> numbers = absl::StrSplit(version, '.');
  Series series;
  if (numbers.size() != 3 || !absl::SimpleAtoi(numbers[0], &series.major) ||
      !absl::SimpleAtoi(numbers[1], &series.minor) || series.major < 0 || series.minor < 0) {
    return std::nullopt;
  }
  if (series.major > 0) series.minor = 0;
  return series;
}

}  // namespace

absl::Status CheckClientVersion(absl::string_view user_agent, absl::string_view server) {
  if (!absl::ConsumePrefix(&user_agent, "ballpiston/")) return absl::OkStatus();
  const absl::string_view client = user_agent.substr(0, user_agent.find(' '));
  const std::optional<Series> of_client = SeriesOf(client), of_server = SeriesOf(server);
  if (!of_client || !of_server || *of_client == *of_server) return absl::OkStatus();
  return WithReason(
      absl::FailedPreconditionError(absl::StrCat(
          "this server has version ", server, " and serves clients of version ", of_server->Text(),
          "; this client has version ", client, ". Install version ", of_server->Text(),
          " of the client, or version ", of_client->Text(),
          " of the server and restart it (a private one: ballpiston server stop)")),
      "CLIENT_VERSION_NOT_SERVED", "server_version", std::string(server));
}

}  // namespace ballpiston::server
