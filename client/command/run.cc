// ballpiston submit and run: submit a job; run also watches it and prints its result.
#include "absl/strings/str_cat.h"
#include "client/command/connection.h"
#include "client/command/create_job.h"
#include "client/command/follow_job.h"
#include "client/command/print_result.h"
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

VerbResult Run(const Options& options, Terminal& terminal) {
  if (absl::Status bad = CheckSave(options); !bad.ok()) return bad;
  return WithQuestion(
      options, terminal,
      [&](const Connection& connection, const v1::EnsembleSpec& spec) -> VerbResult {
        const auto made = CreateJob(connection, spec, options, terminal);
        if (!made.ok()) return made.status();
        const bool is_silent = options.quiet || options.progress == ProgressStyle::kNone;
        const std::string reused = ReusedText(*made);
        if (!reused.empty() && !is_silent) {
          ProgressReporter(StyleOf(options), terminal.err, made->name()).Note(reused);
        }
        const auto end = FollowJob(connection, made->name(), StyleOf(options), terminal);
        if (!end.ok()) return end.status();
        // A pipeline takes a file that exists for a complete one.
        if (!options.save.empty() && end->state() != v1::EnsembleJob::SUCCEEDED) {
          terminal.Note(absl::StrCat(
              options.save, " is not written; to save the finished points: ballpiston result ",
              made->name(), " --save ", options.save, connection.flags));
          return ReportEnd(*end, terminal);
        }
        return PrintResult(connection, made->name(), options, terminal,
                           made->answered_from_store());
      });
}

}  // namespace ballpiston::client
