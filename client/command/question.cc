#include "client/command/question.h"

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/command/spec_file.h"
#include "client/command/verb_table.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

absl::Status CheckOneTarget(const std::set<std::string>& flags) {
  std::vector<std::string> given;
  for (const Flag& flag : TargetFlags().flags) {
    if (flags.contains(flag.name)) given.push_back(flag.name);
  }
  const bool is_pair = given == std::vector<std::string>{"--tolerance", "--budget"};
  if (given.size() <= 1 || is_pair) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(absl::StrJoin(given, " and "),
                   " exclude each other: give at most one of --samples, --collisions, --tolerance, "
                   "--budget; only --tolerance and --budget may stand together"));
}

// Looks at flags on the command line only: with --spec, those of the config file are ignored.
bool HasQuestionFlags(const Options& options) {
  for (const FlagGroup* group : QuestionFlags()) {
    for (const Flag& flag : group->flags) {
      if (flag.name != "--spec" && options.given.contains(flag.name)) return true;
    }
  }
  return options.spec.experiment() != v1::EnsembleSpec::EXPERIMENT_UNSPECIFIED;
}

}  // namespace

absl::StatusOr<v1::EnsembleSpec> SpecOf(const Options& options) {
  if (!options.spec_file.empty()) {
    if (!HasQuestionFlags(options)) return ReadSpecFile(options.spec_file);
    return absl::InvalidArgumentError(
        "--spec holds the whole specification: give no EXPERIMENT, grid, target, --seed, --model, "
        "--verify or --precision with it");
  }
  if (options.spec.experiment() == v1::EnsembleSpec::EXPERIMENT_UNSPECIFIED) {
    return absl::InvalidArgumentError(absl::StrCat(
        "name an EXPERIMENT (", absl::StrJoin(Spellings<v1::EnsembleSpec::Experiment>(), ", "),
        ") or give --spec FILE"));
  }
  if (absl::Status bad = CheckOneTarget(options.given); !bad.ok()) return bad;
  return options.spec;
}

}  // namespace ballpiston::client
