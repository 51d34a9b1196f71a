#include "server/rpc/client_version.h"

#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

bool IsNumber(const std::string& text) {
  return !text.empty() && text.size() <= 9 &&
         std::all_of(text.begin(), text.end(), &absl::ascii_isdigit);
}

// The numbers whose change breaks clients: major, and before 1.0.0 minor. Empty if this is not a
// version.
std::string SeriesOf(absl::string_view version) {
  const std::vector<std::string> numbers = absl::StrSplit(version, '.');
  if (numbers.size() != 3 || !IsNumber(numbers[0]) || !IsNumber(numbers[1])) return "";
  return numbers[0] == "0" ? absl::StrCat("0.", numbers[1]) : numbers[0];
}

}  // namespace

absl::Status CheckClientVersion(absl::string_view user_agent, absl::string_view server) {
  if (!absl::ConsumePrefix(&user_agent, "ballpiston/")) return absl::OkStatus();
  const absl::string_view client = user_agent.substr(0, user_agent.find(' '));
  const std::string of_client = SeriesOf(client), of_server = SeriesOf(server);
  if (of_client.empty() || of_client == of_server) return absl::OkStatus();
  return WithReason(absl::FailedPreconditionError(absl::StrCat(
                        "this server has version ", server, " and serves clients of version ",
                        of_server, "; this client has version ", client, ". Install version ",
                        of_server, " of the client, or version ", of_client,
                        " of the server and restart it (a private one: ballpiston server stop)")),
                    "CLIENT_VERSION_NOT_SERVED", {{"server_version", std::string(server)}});
}

}  // namespace ballpiston::server
