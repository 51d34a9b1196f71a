// ballpiston cancel, delete, pin and label: each changes jobs, and prints the new state of each.
#include <iostream>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/command/connection.h"
#include "client/output/answers.h"
#include "client/output/number_text.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

// With --label and without --yes, prints how many jobs `action` ("delete") concerns and whose they
// are, and reads the answer. CANCELLED if it is not y or yes.
absl::Status Confirm(const std::string& action, const std::vector<v1::EnsembleJob>& jobs,
                     const Options& options, const Terminal& terminal) {
  if (!options.jobs.empty() || options.yes || jobs.empty()) return absl::OkStatus();
  std::set<std::string> owners;
  for (const v1::EnsembleJob& job : jobs) owners.insert(job.principal());
  terminal.err << action << ' ' << Counted(static_cast<double>(jobs.size()), "job") << " of "
               << absl::StrJoin(owners, ", ") << "? [y/N] " << std::flush;
  std::string answer;
  std::getline(std::cin, answer);
  absl::AsciiStrToLower(&answer);
  if (answer == "y" || answer == "yes") return absl::OkStatus();
  return absl::CancelledError("nothing was changed (--yes answers the question)");
}

absl::Status CancelJob(const Connection& connection, const std::string& name, const Options&,
                       const Terminal& terminal) {
  const auto job = connection.client.Cancel(name);
  if (!job.ok()) return job.status();
  terminal.out << job->name() << ' ' << Spelling(job->state()) << std::endl;
  terminal.Note(absl::StrCat(name, ": ", job->progress().points_done(), " of ",
                             job->progress().points(), " points are finished and stay"));
  return absl::OkStatus();
}

// A delete is not retried: if its answer was lost, a second attempt would find no such job.
absl::Status DeleteJob(const Connection& connection, const std::string& name, const Options&,
                       const Terminal& terminal) {
  const absl::Status status = connection.client.Delete(name);
  if (status.ok()) terminal.out << name << " deleted" << std::endl;
  const bool is_open = absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status);
  if (is_open) terminal.err << "ballpiston: " << name << " may have been deleted" << std::endl;
  return status;
}

absl::Status PinJob(const Connection& connection, const std::string& name, const Options& options,
                    const Terminal& terminal) {
  const auto job = connection.client.Pin(name, !options.undo);
  if (!job.ok()) return HintIfExpired(job.status(), connection, name);
  terminal.out << job->name() << (job->pinned() ? " pinned" : " unpinned") << std::endl;
  return absl::OkStatus();
}

// Changes every job, also after an error. Returns the first error. A pinned job is deleted only by
// its name.
VerbResult Change(const std::string& action, decltype(&CancelJob) change, const JobStates& states,
                  const Options& options, const Terminal& terminal) {
  const auto stays = [&](const v1::EnsembleJob& job) {
    const bool is_kept = job.pinned() && change == &DeleteJob;
    if (is_kept)
      terminal.Note(job.name() + " is pinned and was not deleted; to delete it, give its name");
    return is_kept;
  };
  return WithJobs(options, terminal, states, [&](const auto& connection, auto jobs) -> VerbResult {
    std::erase_if(jobs, stays);
    absl::Status status = Confirm(action, jobs, options, terminal);
    if (!status.ok()) return status;
    for (const auto& job : jobs) status.Update(change(connection, job.name(), options, terminal));
    return status.ok() ? VerbResult(ExitCode::kDone) : status;
  });
}

}  // namespace

VerbResult Cancel(const Options& options, Terminal& terminal) {
  return Change("cancel", &CancelJob, kActiveStates, options, terminal);
}

VerbResult Delete(const Options& options, Terminal& terminal) {
  return Change("delete", &DeleteJob, kEndedStates, options, terminal);
}

VerbResult Pin(const Options& options, Terminal& terminal) {
  return Change("pin", &PinJob, {}, options, terminal);
}

// If two clients change the labels of a job at the same time, the later change may undo the other.
VerbResult Label(const Options& options, Terminal& terminal) {
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const std::string& name = options.jobs.front();
    const auto job = connection.client.Get(name);
    if (!job.ok()) return job.status();
    std::map<std::string, std::string> labels(job->labels().begin(), job->labels().end());
    for (const auto& [key, value] : options.labels) labels[key] = value;
    std::erase_if(labels, [](const auto& label) { return label.second.empty(); });
    const auto changed = connection.client.SetLabels(name, labels);
    if (!changed.ok()) return changed.status();
    terminal.out << changed->name() << ' ' << LabelsText(*changed) << '\n';
    return ExitCode::kDone;
  });
}

}  // namespace ballpiston::client
