#include "client/command/print_result.h"

#include <memory>

#include "absl/strings/str_cat.h"
#include "client/command/follow_job.h"
#include "client/command/hint.h"
#include "client/output/number_text.h"
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

// If the server restarts, requests only the current page again: the earlier pages have been
// printed. Calls writer.Begin when the first page has arrived.
absl::Status PrintPoints(const Connection& connection, const v1::EnsembleJob& job, Format format,
                         ResultWriter& writer, std::ostream& err) {
  std::string token;
  do {
    const auto page = connection.Ask(
        [&] { return connection.client.ResultsPage(job.name(), ViewFor(format), token); });
    if (!page.ok()) return HintIfExpired(page.status(), connection, job.name());
    if (token.empty()) writer.Begin(job);
    for (const v1::PointResult& point : page->points()) AddPoint(point, writer, err);
    token = page->next_page_token();
  } while (!token.empty());
  return absl::OkStatus();
}

VerbResult End(const v1::EnsembleJob& job, ResultWriter& writer, Terminal& terminal) {
  writer.End();
  terminal.out.flush();
  if (HasEnded(job.state())) return ReportEnd(job, terminal);
  NoteUnfinished(job, terminal);
  return ExitCode::kDone;
}

}  // namespace

VerbResult PrintResult(const Connection& connection, const std::string& name, Format format,
                       Terminal& terminal, bool answered_from_store) {
  auto job = connection.Ask([&] { return connection.client.Get(name); });
  if (!job.ok()) return job.status();
  job->set_answered_from_store(answered_from_store);
  const std::unique_ptr<ResultWriter> writer = NewResultWriter(format, terminal.out);
  const absl::Status status = PrintPoints(connection, *job, format, *writer, terminal.err);
  if (!status.ok()) return status;
  return End(*job, *writer, terminal);
}

VerbResult PrintPoint(const Connection& connection, const std::string& name, int64_t index,
                      Format format, Terminal& terminal) {
  const auto point = connection.Ask([&] { return connection.client.Point(name, index); });
  if (!point.ok()) return HintIfExpired(point.status(), connection, name);
  const auto job = connection.Ask([&] { return connection.client.Get(name); });
  if (!job.ok()) return job.status();
  const std::unique_ptr<ResultWriter> writer = NewResultWriter(format, terminal.out);
  writer->Begin(*job);
  AddPoint(*point, *writer, terminal.err);
  return End(*job, *writer, terminal);
}

}  // namespace ballpiston::client
