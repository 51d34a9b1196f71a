// ballpiston submit, run and result: submit a job; run also watches it and prints its result.
#include <algorithm>
#include <filesystem>
#include <map>
#include <system_error>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "client/command/connection.h"
#include "client/command/follow_job.h"
#include "client/command/interrupts.h"
#include "client/command/python.h"
#include "client/command/question.h"
#include "client/command/verb_table.h"
#include "client/library/error_text.h"
#include "client/library/quoted.h"
#include "client/library/request_id.h"
#include "client/output/number_text.h"
#include "client/output/output_file.h"
#include "client/output/point_output.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

// ---- submit ----

// If the user interrupts the call, a message shows the request id.
absl::StatusOr<v1::EnsembleJob> CreateOnce(const Connection& connection,
                                           const v1::CreateEnsembleJobRequest& request,
                                           const Terminal& terminal) {
  const OnInterrupt scope([&] {
    terminal.err << "The server may have accepted the job. With --request-id "
                 << request.request_id() << " the same command returns this job.\n";
  });
  terminal.Detail(absl::StrCat("request id ", request.request_id()));
  auto job = connection.client.Create(request);
  if (!job.ok()) return job;
  terminal.Detail(absl::StrCat("job ", job->name()));
  return job;
}

// Tries ids in order. If the job of an id failed or was cancelled, or its results have expired, the
// next id creates a new job.
absl::StatusOr<v1::EnsembleJob> Resume(const Connection& connection,
                                       v1::CreateEnsembleJobRequest request,
                                       const std::map<std::string, std::string>& labels,
                                       const Terminal& terminal) {
  const auto status = connection.client.Status();
  if (!status.ok()) return status.status();
  std::string question =
      absl::StrCat(status->engine_version(), " ", request.fresh(), " ", request.priority(), " ",
                   request.spec().SerializeAsString(), " ");
  for (const auto& [key, value] : labels) absl::StrAppend(&question, key, "=", value, " ");
  for (int attempt = 0;; ++attempt) {
    request.set_request_id(RequestIdFor(absl::StrCat(question, attempt)));
    auto job = CreateOnce(connection, request, terminal);
    const bool is_lost =
        job.ok() &&
        (job->state() == v1::EnsembleJob::FAILED || job->state() == v1::EnsembleJob::CANCELLED ||
         job->state() == v1::EnsembleJob::CANCELLING || job->results_expired());
    if (!is_lost) return job;
  }
}

// A retry (library/client.h) uses the same request id: if a private server stored the job and
// stopped before it answered, the retry returns that job. With --resume the id is derived from the
// specification and the engine's version.
absl::StatusOr<v1::EnsembleJob> CreateJob(const Connection& connection, const Options& options,
                                          const Terminal& terminal) {
  v1::CreateEnsembleJobRequest request = options.create;
  *request.mutable_spec() = options.spec;
  request.mutable_labels()->insert(options.labels.begin(), options.labels.end());
  const bool has_id = !request.request_id().empty();
  if (options.resume && !has_id) return Resume(connection, request, options.labels, terminal);
  if (!has_id) request.set_request_id(NewRequestId());
  return CreateOnce(connection, request, terminal);
}

// The note for a job that uses what is stored, else empty.
std::string ReusedText(const v1::EnsembleJob& job) {
  if (job.answered_from_store()) {
    const auto text = [](const google::protobuf::Timestamp& time) {
      return absl::FormatTime("%Y-%m-%d %H:%M UTC", absl::FromUnixSeconds(time.seconds()),
                              absl::UTCTimeZone());
    };
    const bool may_expire = job.has_expire_time() && !job.pinned();
    return absl::StrCat(
        "answered from the store: ", job.name(), ", computed ", text(job.end_time()),
        may_expire ? ", expires " + text(job.expire_time()) : "", " (--fresh computes it again)");
  }
  if (job.continues().empty()) return "";
  return absl::StrCat("continues ", job.continues(), ": what it needs of the ",
                      ExactText(job.continued_samples()),
                      " stored samples is not computed again (--fresh computes all)");
}

// ---- result ----

// An orbit that left its cell is a defect of the engine, and the warning must not be missed.
void AddPoint(const v1::PointResult& point, ResultWriter& writer, std::ostream& err) {
  writer.Add(point);
  if (point.health().escapes() == 0) return;
  err << "ballpiston: warning: point " << point.index() << ": "
      << ExactText(point.health().escapes())
      << " orbits left the cell; this is a defect: do not use the point\n";
}

bool IsNpz(const Options& options) { return absl::EndsWith(options.save, ".npz"); }

// The Python package makes .npz of .json.
Format FormatOf(const Options& options) {
  if (options.save.empty()) return options.format;
  return absl::EndsWith(options.save, ".csv") ? Format::kCsv : Format::kJson;
}

// One page of the finished points, or the point of --point.
absl::StatusOr<v1::ListResultsResponse> PageOf(const Connection& connection,
                                               const std::string& name, const Options& options,
                                               const std::string& token) {
  if (!options.point) {
    using Request = v1::ListResultsRequest;
    const auto view = IsJson(FormatOf(options)) ? Request::FULL : Request::BASIC;
    return connection.client.ResultsPage(name, view, token);
  }
  auto point = connection.client.Point(name, *options.point);
  if (!point.ok()) return point.status();
  v1::ListResultsResponse page;
  *page.add_results() = *std::move(point);
  return page;
}

// If the server restarts, requests only the current page again: the earlier pages have been
// printed. Prints nothing before the first page has arrived. `has_names`: also prints the names of
// the points. They contain the job's id; without them the same points give the same bytes.
// `options` must have passed CheckSave.
absl::Status PrintPoints(const Connection& connection, const v1::EnsembleJob& job,
                         const Options& options, bool has_names, std::ostream& out,
                         std::ostream& err) {
  ResultWriter writer(FormatOf(options), out, /*is_file=*/!options.save.empty());
  std::string token;
  do {
    auto page = PageOf(connection, job.name(), options, token);
    if (!page.ok()) return HintIfExpired(page.status(), connection, job.name());
    if (token.empty()) writer.Begin(job);
    for (v1::PointResult& point : *page->mutable_results()) {
      if (!has_names) point.clear_name();
      AddPoint(point, writer, err);
    }
    token = page->next_page_token();
  } while (!token.empty() && out.good());  // not after a failed write or a closed pipe
  writer.End();
  return absl::OkStatus();
}

// Replaces the content of the unfinished file, a result in JSON, by NumPy arrays.
absl::Status ToArrays(NewFile& file, const Options& options, Terminal& terminal) {
  if (absl::Status written = file.Flush(); !written.ok()) return written;
  const VerbResult end =
      RunPythonProgram("ballpiston.command", {"arrays", file.part().string()}, options, terminal);
  if (!end.ok()) return end.status();
  if (*end == ExitCode::kDone) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("--save: ", options.save, " is not written"));
}

// Writes the file of --save, and prints its path. `options` must have passed CheckSave.
absl::Status SavePoints(const Connection& connection, const v1::EnsembleJob& job,
                        const Options& options, bool has_names, Terminal& terminal) {
  NewFile file("--save", options.save);
  absl::Status saved = PrintPoints(connection, job, options, has_names, file.out(), terminal.err);
  if (saved.ok() && IsNpz(options)) saved = ToArrays(file, options, terminal);
  if (saved.ok()) saved = file.Keep();
  if (saved.ok()) terminal.out << options.save << '\n';
  return saved;
}

// Checks --save before a job runs: the file's ending, kind and folder.
absl::Status CheckSave(const Options& options) {
  if (options.save.empty()) return absl::OkStatus();
  const bool is_csv = absl::EndsWith(options.save, ".csv");
  if (!is_csv && !IsNpz(options) && !absl::EndsWith(options.save, ".json")) {
    return absl::InvalidArgumentError(
        absl::StrCat("--save: ", Quoted(options.save), " does not end in .json, .csv or .npz"));
  }
  const bool is_usual = options.format == Format::kTable || !options.given.contains("--format");
  if (!is_usual && (IsNpz(options) || options.format != FormatOf(options))) {
    return absl::InvalidArgumentError(
        absl::StrCat("--save: ", options.save, " does not go with --format ",
                     WordOf(options.format, kFormats), "; permitted: no --format",
                     IsNpz(options) ? "" : ", or --format " + WordOf(FormatOf(options), kFormats)));
  }
  if (absl::Status bad = CheckNewFile("--save", options.save); !bad.ok()) return bad;
  if (!IsNpz(options)) return absl::OkStatus();
  std::error_code error;
  const std::filesystem::file_status found = std::filesystem::status(options.save, error);
  if (std::filesystem::exists(found) && !std::filesystem::is_regular_file(found)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--save: ", options.save, " is not a regular file; .npz needs one"));
  }
  return CheckPythonFor("--save " + options.save);
}

// Prints the finished points, also of a job that failed or was cancelled. `answered_from_store` is
// the value that Create returned: the server does not store it.
VerbResult PrintResult(const Connection& connection, const std::string& name,
                       const Options& options, Terminal& terminal, bool answered_from_store,
                       bool has_names = false) {
  auto job = connection.client.Get(name);
  if (!job.ok()) return job.status();
  job->set_answered_from_store(answered_from_store);
  const absl::Status printed =
      options.save.empty()
          ? PrintPoints(connection, *job, options, has_names, terminal.out, terminal.err)
          : SavePoints(connection, *job, options, has_names, terminal);
  if (!printed.ok()) return printed;
  terminal.out.flush();
  if (HasEnded(job->state())) return ReportEnd(*job, terminal);
  terminal.Note(absl::StrCat("ballpiston: ", name, " is still ", Spelling(job->state()), ": ",
                             job->progress().points_done(), " of ", job->progress().points(),
                             " points are finished"));
  return ExitCode::kDone;
}

}  // namespace

VerbResult Submit(const Options& options, Terminal& terminal) {
  return WithQuestion(options, terminal,
                      [&](const Connection& connection, const Options& asked) -> VerbResult {
                        const auto job = CreateJob(connection, asked, terminal);
                        if (!job.ok()) return job.status();
                        const std::string reused = ReusedText(*job);
                        if (!reused.empty()) terminal.Note(reused);
                        terminal.out << job->name() << '\n';
                        return ExitCode::kDone;
                      });
}

VerbResult Run(const Options& options, Terminal& terminal) {
  if (absl::Status bad = CheckSave(options); !bad.ok()) return bad;
  return WithQuestion(
      options, terminal, [&](const Connection& connection, const Options& asked) -> VerbResult {
        const auto made = CreateJob(connection, asked, terminal);
        if (!made.ok()) return made.status();
        const bool is_silent =
            options.verbosity == Verbosity::kQuiet || options.progress == ProgressStyle::kNone;
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

VerbResult Result(const Options& options, Terminal& terminal) {
  if (absl::Status bad = CheckSave(options); !bad.ok()) return bad;
  return WithJobs(
      options, terminal, {}, [&](const auto& connection, const auto& jobs) -> VerbResult {
        if (jobs.size() > 1 && (!options.save.empty() || options.format == Format::kCsv)) {
          return absl::InvalidArgumentError(
              absl::StrCat("--save and CSV are for the result of one job, not of ", jobs.size(),
                           "; ballpiston export writes the estimates of many"));
        }
        // A label may stand for one job today and for two tomorrow.
        const bool may_be_many = jobs.size() > 1 || options.jobs.empty();
        const bool has_names = may_be_many && FormatOf(options) == Format::kJsonl;
        ExitCode worst = ExitCode::kDone;
        absl::Status missing;
        for (const v1::EnsembleJob& job : jobs) {
          const VerbResult result = PrintResult(connection, job.name(), options, terminal,
                                                /*answered_from_store=*/false, has_names);
          const bool is_missing = absl::IsNotFound(result.status()) ||
                                  ErrorReason(result.status()) == "RESULTS_EXPIRED";
          if (!result.ok() && !is_missing) return result;
          missing.Update(result.status());
          if (result.ok()) worst = std::max(worst, *result);
        }
        return missing.ok() ? VerbResult(worst) : missing;
      });
}

}  // namespace ballpiston::client
