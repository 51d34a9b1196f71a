#include "client/command/print_result.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "absl/strings/str_cat.h"
#include "client/command/follow_job.h"
#include "client/command/python.h"
#include "client/command/selection.h"
#include "client/library/child_process.h"
#include "client/output/new_file.h"
#include "client/output/number_text.h"
#include "client/output/result_file.h"
#include "client/output/result_writer.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

// An orbit that left its cell is a defect of the engine, and the warning must not be missed.
void WarnOfEscapes(const v1::PointResult& point, std::ostream& err) {
  if (point.health().escapes() == 0) return;
  err << "ballpiston: warning: point " << point.index() << ": "
      << ExactText(point.health().escapes())
      << " orbits left the cell; this is a defect: do not use the point\n";
}

void NoteUnfinished(const v1::EnsembleJob& job, const Terminal& terminal) {
  terminal.Note(absl::StrCat("ballpiston: ", job.name(), " is still ", Spelling(job.state()), ": ",
                             job.progress().points_done(), " of ", job.progress().points(),
                             " points are finished"));
}

void AddPoint(const v1::PointResult& point, ResultWriter& writer, std::ostream& err) {
  writer.Add(point);
  WarnOfEscapes(point, err);
}

// Replaces the content of the unfinished file, a result in JSON, by NumPy arrays.
absl::Status ToArrays(NewFile& file, const std::string& path) {
  if (absl::Status written = file.Flush(); !written.ok()) return written;
  const std::string part = file.part().string();
  if (part.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--save: ", path, " is not a regular file, as .npz needs it"));
  }
  const auto status = RunChild({.command = PythonCommand({"-m", "ballpiston.to_arrays", part})});
  if (!status.ok()) return status.status();
  if (*status == 0) return absl::OkStatus();
  return absl::InternalError(
      absl::StrCat("--save: ", path, " is not written: Python ended with exit status ", *status));
}

// Where a result goes: standard output, or the file of --save.
class Destination {
 public:
  // `options` must have passed CheckSave.
  Destination(const Options& options, Terminal& terminal) : terminal_(terminal) {
    if (options.save.empty()) {
      writer_ = NewResultWriter(options.format, terminal.out);
      view_ = ViewFor(options.format);
      return;
    }
    const FileFormat format = *FormatOfFile(options.save, options.format);
    path_ = options.save;
    is_npz_ = format.is_npz;
    file_.emplace("--save", path_);
    writer_ = NewResultFileWriter(format, file_->out());
    view_ = ViewFor(format);
  }

  v1::ListResultsRequest::View view() const { return view_; }
  ResultWriter& writer() { return *writer_; }

  // Prints the path of the file, once the file is complete.
  absl::Status Finish() {
    writer_->End();
    if (file_) {
      const absl::Status converted = is_npz_ ? ToArrays(*file_, path_) : absl::OkStatus();
      if (!converted.ok()) return converted;
      if (absl::Status kept = file_->Keep(); !kept.ok()) return kept;
      terminal_.out << path_ << '\n';
    }
    terminal_.out.flush();
    return absl::OkStatus();
  }

 private:
  Terminal& terminal_;
  std::string path_;
  bool is_npz_ = false;
  std::optional<NewFile> file_;
  std::unique_ptr<ResultWriter> writer_;
  v1::ListResultsRequest::View view_;
};

// If the server restarts, requests only the current page again: the earlier pages have been
// printed. Calls Begin of the writer when the first page has arrived.
absl::Status PrintPoints(const Connection& connection, const v1::EnsembleJob& job,
                         Destination& destination, std::ostream& err) {
  std::string token;
  do {
    const auto page = connection.client.ResultsPage(job.name(), destination.view(), token);
    if (!page.ok()) return HintIfExpired(page.status(), connection, job.name());
    if (token.empty()) destination.writer().Begin(job);
    for (const v1::PointResult& point : page->results()) {
      AddPoint(point, destination.writer(), err);
    }
    token = page->next_page_token();
  } while (!token.empty());
  return absl::OkStatus();
}

VerbResult End(const v1::EnsembleJob& job, Destination& destination, Terminal& terminal) {
  if (absl::Status finished = destination.Finish(); !finished.ok()) return finished;
  if (HasEnded(job.state())) return ReportEnd(job, terminal);
  NoteUnfinished(job, terminal);
  return ExitCode::kDone;
}

VerbResult PrintPoint(const Connection& connection, const std::string& name, int64_t index,
                      const Options& options, Terminal& terminal) {
  const auto point = connection.client.Point(name, index);
  if (!point.ok()) return HintIfExpired(point.status(), connection, name);
  const auto job = connection.client.Get(name);
  if (!job.ok()) return job.status();
  Destination destination(options, terminal);
  destination.writer().Begin(*job);
  AddPoint(*point, destination.writer(), terminal.err);
  return End(*job, destination, terminal);
}

absl::Status TooMany(size_t jobs) {
  return absl::InvalidArgumentError(
      absl::StrCat("--save and CSV are for the result of one job, not of ", jobs,
                   "; ballpiston export writes the estimates of many"));
}

}  // namespace

absl::Status CheckSave(const Options& options) {
  if (options.save.empty()) return absl::OkStatus();
  const auto format = FormatOfFile(options.save, options.format);
  if (!format.ok()) return format.status();
  if (absl::Status bad = CheckNewFile("--save", options.save); !bad.ok()) return bad;
  if (!format->is_npz) return absl::OkStatus();
  return CheckPython("--save " + options.save, {"ballpiston", "numpy"},
                     "python3-ballpiston and python3-numpy");
}

VerbResult PrintResult(const Connection& connection, const std::string& name,
                       const Options& options, Terminal& terminal, bool answered_from_store) {
  auto job = connection.client.Get(name);
  if (!job.ok()) return job.status();
  job->set_answered_from_store(answered_from_store);
  Destination destination(options, terminal);
  const absl::Status status = PrintPoints(connection, *job, destination, terminal.err);
  if (!status.ok()) return status;
  return End(*job, destination, terminal);
}

VerbResult Result(const Options& options, Terminal& terminal) {
  if (options.point.value_or(0) < 0) {
    return absl::InvalidArgumentError(absl::StrCat("--point: ", *options.point, " is below 0"));
  }
  if (absl::Status bad = CheckSave(options); !bad.ok()) return bad;
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
