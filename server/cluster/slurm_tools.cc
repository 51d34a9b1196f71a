#include "server/cluster/slurm_tools.h"

#include <unistd.h>

#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "server/cluster/run_command.h"

namespace ballpiston::server {
namespace {

// sbatch itself retries for 120 s while the cluster has no room for another job.
constexpr std::chrono::seconds kSubmitLimit(150);
constexpr std::chrono::seconds kOtherLimit(60);
// Before the time limit a task has so long to write its complete chunks. Slurm looks at time limits
// every 30 s, so the signal comes up to 30 s earlier.
constexpr int kSecondsToFinish = 60;

// The tool's error messages, in one line.
std::string ErrorsOf(const CommandOutput& output) {
  std::vector<std::string> lines;
  for (absl::string_view line : absl::StrSplit(output.errors, '\n', absl::SkipWhitespace())) {
    for (const absl::string_view tool : {"sbatch: ", "squeue: ", "scancel: ", "error: "}) {
      absl::ConsumePrefix(&line, tool);
    }
    lines.emplace_back(line);
  }
  return lines.empty() ? absl::StrCat("exit code ", output.exit_code) : absl::StrJoin(lines, "; ");
}

// Quotes a word for sh.
std::string Quoted(const std::string& word) {
  return absl::StrCat("'", absl::StrReplaceAll(word, {{"'", "'\\''"}}), "'");
}

std::string Script(const ArraySubmission& array) {
  std::vector<std::string> words;
  for (const std::string& word : array.command) words.push_back(Quoted(word));
  return absl::StrCat("#!/bin/sh\nexec ", absl::StrJoin(words, " "),
                      " --task \"$SLURM_ARRAY_TASK_ID\"\n");
}

// The tool ran, and whether it succeeded.
absl::StatusOr<CommandOutput> Succeeded(absl::StatusOr<CommandOutput> run,
                                        const std::string& tool) {
  if (!run.ok()) return run.status();
  if (run->exit_code == 0) return run;
  return absl::UnavailableError(absl::StrCat(tool, ": ", ErrorsOf(*run)));
}

// scancel complains of each task that has ended since the query.
bool AllHaveEnded(absl::string_view errors) {
  size_t ended = 0;
  for (const absl::string_view line : absl::StrSplit(errors, '\n', absl::SkipWhitespace())) {
    const bool has_ended = absl::StrContains(line, "Invalid job id specified") ||
                           absl::StrContains(line, "already completing or completed");
    if (!has_ended) return false;
    ++ended;
  }
  return ended > 0;
}

}  // namespace

std::vector<std::string> SlurmEnvironment() {
  std::vector<std::string> kept;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const absl::string_view text = *variable;
    const bool is_slurms =
        absl::StartsWith(text, "SLURM_") && !absl::StartsWith(text, "SLURM_CONF=");
    const bool changes_tools = absl::StartsWith(text, "SBATCH_") ||
                               absl::StartsWith(text, "SQUEUE_") ||
                               absl::StartsWith(text, "SCANCEL_");
    if (!is_slurms && !changes_tools) kept.emplace_back(text);
  }
  kept.push_back("SLURM_BITSTR_LEN=0");
  return kept;
}

std::vector<std::string> SlurmTools::Words(absl::string_view tool) const {
  std::vector<std::string> words = {std::string(tool)};
  if (!options_.cluster.empty()) words.push_back(absl::StrCat("--clusters=", options_.cluster));
  return words;
}

absl::Status SlurmTools::Submit(const ArraySubmission& array, const std::stop_token& stop) {
  Command command = {.words = Words("sbatch"),
                     .environment = SlurmEnvironment(),
                     .input = Script(array),
                     .limit = kSubmitLimit};
  std::vector<std::string>& words = command.words;
  words.insert(words.end(), {"--parsable", absl::StrCat("--job-name=", array.name),
                             absl::StrCat("--array=0-", array.tasks - 1),
                             absl::StrCat("--time=", options_.time_limit_minutes),
                             absl::StrCat("--signal=B:USR1@", kSecondsToFinish), "--requeue",
                             "--open-mode=append", absl::StrCat("--chdir=", array.folder),
                             absl::StrCat("--output=", array.folder, "/%a.log")});
  if (!options_.partition.empty())
    words.push_back(absl::StrCat("--partition=", options_.partition));
  if (!options_.account.empty()) words.push_back(absl::StrCat("--account=", options_.account));
  words.insert(words.end(), options_.sbatch_options.begin(), options_.sbatch_options.end());
  const absl::StatusOr<CommandOutput> run = RunCommand(command, stop);
  const bool was_killed = absl::IsDeadlineExceeded(run.status()) || absl::IsCancelled(run.status());
  if (was_killed) return absl::UnknownError(run.status().message());
  if (!run.ok() || run->exit_code == 0) return run.status();
  const std::string errors = absl::StrCat("sbatch: ", ErrorsOf(*run));
  if (absl::StrContains(errors, "timed out")) return absl::UnknownError(errors);
  return absl::UnavailableError(errors);
}

absl::StatusOr<std::map<std::string, QueuedArray>> SlurmTools::Query(absl::string_view prefix,
                                                                     const std::stop_token& stop) {
  Command command = {
      .words = Words("squeue"), .environment = SlurmEnvironment(), .limit = kOtherLimit};
  command.words.insert(command.words.end(),
                       {"--noheader", "--me", absl::StrCat("--format=", kQueueFormat)});
  const auto run = Succeeded(RunCommand(command, stop), "squeue");
  if (!run.ok()) return run.status();
  return ParseQueue(run->output, prefix);
}

absl::Status SlurmTools::Cancel(const std::string& name, const std::stop_token& stop) {
  Command command = {
      .words = Words("scancel"), .environment = SlurmEnvironment(), .limit = kOtherLimit};
  command.words.insert(command.words.end(), {"--me", absl::StrCat("--name=", name)});
  return Succeeded(RunCommand(command, stop), "scancel").status();
}

absl::Status SlurmTools::CancelTasks(const std::string& name, const std::string& id,
                                     const std::set<size_t>& tasks, const std::stop_token& stop) {
  Command command = {
      .words = Words("scancel"), .environment = SlurmEnvironment(), .limit = kOtherLimit};
  command.words.insert(command.words.end(), {"--me", absl::StrCat("--name=", name),
                                             absl::StrCat(id, "_[", IndicesText(tasks), "]")});
  const absl::StatusOr<CommandOutput> run = RunCommand(command, stop);
  if (run.ok() && AllHaveEnded(run->errors)) return absl::OkStatus();
  return Succeeded(run, "scancel").status();
}

}  // namespace ballpiston::server
