// ballpiston label: sets and removes labels of a job. Prints the job's name and its labels. Of two
// changes at the same time the later one may undo the other.
#include "absl/strings/str_cat.h"
#include "client/command/connection.h"
#include "client/output/job_list.h"

namespace ballpiston::client {

VerbResult Label(const Options& options, Terminal& terminal) {
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    const std::string& name = options.jobs.front();
    const auto job = connection.Ask([&] { return connection.client.Get(name); });
    if (!job.ok()) return job.status();
    std::map<std::string, std::string> labels(job->labels().begin(), job->labels().end());
    for (const auto& [key, value] : options.labels) {
      labels.erase(key);
      if (!value.empty()) labels.emplace(key, value);
    }
    const auto changed = connection.Ask([&] { return connection.client.SetLabels(name, labels); });
    if (!changed.ok()) return changed.status();
    terminal.out << changed->name() << ' ' << LabelsText(*changed) << '\n';
    return ExitCode::kDone;
  });
}

}  // namespace ballpiston::client
