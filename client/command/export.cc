// ballpiston export: writes the estimates of many jobs to one file, by the Python package.
#include "absl/strings/str_cat.h"
#include "client/command/python.h"
#include "client/output/new_file.h"

namespace ballpiston::client {

VerbResult Export(const Options& options, Terminal& terminal) {
  if (options.out.empty()) {
    return absl::InvalidArgumentError("--out is missing: name a file .csv, .npz or .parquet");
  }
  if (!options.jobs.empty() && !options.labels.empty()) {
    return absl::InvalidArgumentError(
        "--label and names of jobs exclude each other: give one of them, or neither");
  }
  if (absl::Status bad = CheckNewFile("--out", options.out); !bad.ok()) return bad;
  if (absl::Status bad = CheckPythonFor(options.out); !bad.ok()) return bad;
  std::vector<std::string> arguments = {"--out", options.out};
  for (const auto& [key, value] : options.labels) {
    arguments.insert(arguments.end(), {"--label", absl::StrCat(key, "=", value)});
  }
  arguments.insert(arguments.end(), options.jobs.begin(), options.jobs.end());
  return RunPythonProgram("ballpiston.export", arguments, options, terminal);
}

}  // namespace ballpiston::client
