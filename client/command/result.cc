// ballpiston result: prints or saves a job's finished points, or one of them; verifies a saved
// file.
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/command/ballpistond.h"
#include "client/command/connection.h"
#include "client/command/print_result.h"

namespace ballpiston::client {
namespace {

absl::Status Check(const Options& options) {
  if (options.verify_file.empty() && options.jobs.empty()) {
    return absl::InvalidArgumentError("JOB is missing: ensembleJobs/ID, or --verify FILE");
  }
  if (!options.verify_file.empty() && !options.jobs.empty()) {
    return absl::InvalidArgumentError("--verify: the file names its job; give no JOB");
  }
  if (!options.verify_file.empty() && !absl::EndsWith(options.verify_file, ".json")) {
    return absl::InvalidArgumentError(
        absl::StrCat("--verify: ", options.verify_file, " is not a .json file that --save wrote"));
  }
  for (const char* flag : {"--save", "--point", "--format"}) {
    if (options.verify_file.empty() || !options.given.contains(flag)) continue;
    return absl::InvalidArgumentError(absl::StrCat(flag, " has no effect with --verify"));
  }
  if (options.point.value_or(0) < 0) {
    return absl::InvalidArgumentError(absl::StrCat("--point: ", *options.point, " is below 0"));
  }
  return CheckSave(options);
}

}  // namespace

VerbResult Result(const Options& options, Terminal& terminal) {
  if (absl::Status bad = Check(options); !bad.ok()) return bad;
  if (!options.verify_file.empty()) {
    return RunBallpistond({"--verify", options.verify_file}, terminal);
  }
  return WithServer(options, terminal, [&](const Connection& connection) {
    const std::string& name = options.jobs.front();
    if (options.point) return PrintPoint(connection, name, *options.point, options, terminal);
    return PrintResult(connection, name, options, terminal);
  });
}

}  // namespace ballpiston::client
