// ballpiston submit: submits a job. Standard output contains only the job's name; a note on
// standard error says if the results were already stored.
#include "client/command/connection.h"
#include "client/command/create_job.h"
#include "client/command/question.h"

namespace ballpiston::client {

VerbResult Submit(const Options& options, Terminal& terminal) {
  return WithQuestion(
      options, terminal,
      [&](const Connection& connection, const v1::EnsembleSpec& spec) -> VerbResult {
        const auto job = CreateJob(connection, spec, options, terminal);
        if (!job.ok()) return job.status();
        if (const std::string reused = ReusedText(*job); !reused.empty()) terminal.Note(reused);
        terminal.out << job->name() << '\n';
        return ExitCode::kDone;
      });
}

}  // namespace ballpiston::client
