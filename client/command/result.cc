// ballpiston result: prints or saves a job's finished points, or one of them.
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "client/command/connection.h"
#include "client/command/print_result.h"
#include "client/command/selection.h"

namespace ballpiston::client {
namespace {

absl::Status Check(const Options& options) {
  if (options.point.value_or(0) < 0) {
    return absl::InvalidArgumentError(absl::StrCat("--point: ", *options.point, " is below 0"));
  }
  return CheckSave(options);
}

absl::Status TooMany(size_t jobs) {
  return absl::InvalidArgumentError(
      absl::StrCat("--save and CSV are for the result of one job, not of ", jobs,
                   "; ballpiston export writes the estimates of many"));
}

}  // namespace

VerbResult Result(const Options& options, Terminal& terminal) {
  if (absl::Status bad = Check(options); !bad.ok()) return bad;
  return WithJobs(
      options, terminal, {}, [&](const auto& connection, const auto& names) -> VerbResult {
        if (names.size() > 1 && (!options.save.empty() || IsCsv(options.format))) {
          return TooMany(names.size());
        }
        ExitCode worst = ExitCode::kDone;
        for (const std::string& name : names) {
          const VerbResult result =
              options.point ? PrintPoint(connection, name, *options.point, options, terminal)
                            : PrintResult(connection, name, options, terminal);
          if (!result.ok()) return result;
          worst = std::max(worst, *result);
        }
        return worst;
      });
}

}  // namespace ballpiston::client
