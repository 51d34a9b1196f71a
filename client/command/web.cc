// ballpiston web: serves the page on this machine, and forwards JSON calls to the server.
#include "absl/strings/str_cat.h"
#include "client/command/connection.h"
#include "client/web/web_server.h"

namespace ballpiston::client {
namespace {

constexpr int64_t kMostPort = 65535;

// A private server stops when it is idle. Then restarts the server and retries the call, unless a
// part of the answer has already arrived. Client::Delete says why a deletion is not retried.
absl::Status CallThrough(const Connection& connection, const JsonCall& once,
                         const JsonReceiver& receive) {
  const JsonCall call = WithRequestId(once);
  bool has_begun = false;
  const auto attempt = [&] {
    return CallWithJson(connection.channel, call, [&](const std::string& answer) {
      has_begun = true;
      return receive(answer);
    });
  };
  absl::Status status = attempt();
  const bool may_repeat =
      !has_begun && call.method->input_type() != v1::DeleteEnsembleJobRequest::descriptor();
  if (may_repeat && connection.client.IsBack(status)) status = attempt();
  return NameServer(status, connection);
}

}  // namespace

VerbResult Web(const Options& options, Terminal& terminal) {
  if (options.port < 0 || options.port > kMostPort) {
    return absl::InvalidArgumentError(
        absl::StrCat("--port: ", options.port, " is not from 0 to ", kMostPort));
  }
  const auto files = ReadPageFiles();
  if (!files.ok()) return files.status();
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const auto call = [&](const JsonCall& once, const JsonReceiver& receive) {
      return CallThrough(connection, once, receive);
    };
    const auto announce = [&](const std::string& url) {
      terminal.out << url << std::endl;
      terminal.Note(
          "Ctrl-C stops the page, but not the jobs. Keep the address secret: anyone who has it can "
          "use the server in your name.");
    };
    const absl::Status served = ServePage(*files, call, static_cast<int>(options.port), announce);
    if (served.ok()) return ExitCode::kDone;
    return absl::FailedPreconditionError(
        absl::StrCat("--port ", options.port, ": ", served.message()));
  });
}

}  // namespace ballpiston::client
