// ballpiston report: one HTML file with the pictures, tables and specifications of jobs.
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "client/command/connection.h"
#include "client/library/error_text.h"
#include "client/output/json.h"
#include "client/output/output_file.h"
#include "client/output/page_files.h"

namespace ballpiston::client {
namespace {

constexpr size_t kMostPoints = 10'000;  // of a job; some 6 MB
constexpr size_t kMostPictured = 12;    // points with histograms and curves; as in report.js

// The points of the job as JSON. If its results have expired, or expire now: those fetched so far.
absl::StatusOr<std::vector<std::string>> PointsOf(const Connection& connection,
                                                  const std::string& name) {
  std::vector<std::string> points;
  std::string token;
  do {
    const auto page = connection.client.ResultsPage(name, v1::ListResultsRequest::BASIC, token);
    if (ErrorReason(page.status()) == "RESULTS_EXPIRED") return points;
    if (!page.ok()) return page.status();
    for (const v1::PointResult& point : page->results()) {
      if (points.size() == kMostPoints) return points;
      if (points.size() >= kMostPictured) {
        points.push_back(Json(point));
        continue;
      }
      const auto whole = connection.client.Point(name, point.index());
      if (ErrorReason(whole.status()) == "RESULTS_EXPIRED") return points;
      if (!whole.ok()) return whole.status();
      points.push_back(Json(*whole));
    }
    token = page->next_page_token();
  } while (!token.empty());
  return points;
}

// The job is fetched after the points and counts all of them, so the page can compute how many are
// left out.
absl::StatusOr<std::string> JobJson(const Connection& connection, const std::string& name) {
  const auto points = PointsOf(connection, name);
  if (!points.ok()) return points.status();
  const auto job = connection.client.Get(name);
  if (!job.ok()) return job.status();
  return absl::StrCat("{\"job\":", Json(*job), ",\"points\":[", absl::StrJoin(*points, ",\n"),
                      "]}");
}

absl::StatusOr<std::string> Data(const Connection& connection,
                                 const std::vector<v1::EnsembleJob>& jobs) {
  std::vector<std::string> texts;
  for (const v1::EnsembleJob& job : jobs) {
    const auto text = JobJson(connection, job.name());
    if (!text.ok()) return text.status();
    texts.push_back(*text);
  }
  return absl::StrCat("{\"client_version\":\"", BALLPISTON_VERSION, "\",\"created\":\"",
                      absl::FormatTime(absl::RFC3339_sec, absl::Now(), absl::UTCTimeZone()),
                      "\",\"jobs\":[", absl::StrJoin(texts, ",\n"), "]}");
}

}  // namespace

VerbResult ReportJobs(const Options& options, Terminal& terminal) {
  if (absl::Status bad = CheckNewFile("--out", options.out); !bad.ok()) return bad;
  const auto files = ReadPageFiles();
  if (!files.ok()) return files.status();
  return WithJobs(options, terminal, {},
                  [&](const auto& connection, const auto& jobs) -> VerbResult {
                    const auto data = Data(connection, jobs);
                    if (!data.ok()) return data.status();
                    const auto page = OneFilePage(*files, "report.html", *data);
                    if (!page.ok()) return page.status();
                    NewFile file("--out", options.out);
                    file.out() << *page;
                    if (absl::Status kept = file.Keep(); !kept.ok()) return kept;
                    terminal.out << options.out << '\n';
                    return ExitCode::kDone;
                  });
}

}  // namespace ballpiston::client
