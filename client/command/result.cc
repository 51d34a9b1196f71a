// ballpiston result: prints or saves a job's finished points, or one of them.
#include "absl/strings/str_cat.h"
#include "client/command/connection.h"
#include "client/command/print_result.h"

namespace ballpiston::client {
namespace {

absl::Status Check(const Options& options) {
  if (options.point.value_or(0) < 0) {
    return absl::InvalidArgumentError(absl::StrCat("--point: ", *options.point, " is below 0"));
  }
  return CheckSave(options);
}

}  // namespace

VerbResult Result(const Options& options, Terminal& terminal) {
  if (absl::Status bad = Check(options); !bad.ok()) return bad;
  return WithServer(options, terminal, [&](const Connection& connection) {
    const std::string& name = options.jobs.front();
    if (options.point) return PrintPoint(connection, name, *options.point, options, terminal);
    return PrintResult(connection, name, options, terminal);
  });
}

}  // namespace ballpiston::client
