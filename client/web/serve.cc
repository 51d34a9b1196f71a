// ballpiston-web has the main function and the verbs of ballpiston, but its verb `web` serves the
// page on this machine, and forwards JSON calls to the server.
#include "absl/strings/str_cat.h"
#include "client/command/connection.h"
#include "client/web/web_server.h"

namespace ballpiston::client {
namespace {

VerbResult Serve(const Options& options, Terminal& terminal) {
  const auto files = ReadPageFiles();
  if (!files.ok()) return files.status();
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const auto announce = [&](const std::string& url) {
      terminal.out << url << std::endl;
      terminal.Note(
          "Ctrl-C stops the page, but not the jobs. Keep the address secret: anyone who has it can "
          "use the server in your name.");
    };
    const absl::Status served =
        ServePage(*files, connection, static_cast<int>(options.port), announce);
    if (served.ok()) return ExitCode::kDone;
    return absl::InvalidArgumentError(
        absl::StrCat("--port ", options.port, ": ", served.message()));
  });
}

[[maybe_unused]] const bool kIsSet = (serve_page = &Serve, true);

}  // namespace
}  // namespace ballpiston::client
