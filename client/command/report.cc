// ballpiston report: one HTML file with the pictures, tables and specifications of jobs.
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "client/command/connection.h"
#include "client/command/selection.h"
#include "client/output/json.h"
#include "client/output/new_file.h"
#include "client/web/page_files.h"

namespace ballpiston::client {
namespace {

constexpr size_t kMostPoints = 10'000;  // of a job; some 6 MB
constexpr size_t kMostPictured = 12;    // points with histograms and curves; as in report.js

struct Points {
  std::vector<std::string> json;
  bool is_complete = true;
};

absl::StatusOr<Points> PointsOf(const Connection& connection, const std::string& name) {
  Points points;
  std::string token;
  do {
    const bool pictured = points.json.size() < kMostPictured;
    const auto view = pictured ? v1::ListResultsRequest::FULL : v1::ListResultsRequest::BASIC;
    const auto page = connection.client.ResultsPage(name, view, token);
    if (!page.ok()) return HintIfExpired(page.status(), connection, name);
    for (v1::PointResult point : page->results()) {
      if (points.json.size() == kMostPoints) {
        points.is_complete = false;
        return points;
      }
      if (points.json.size() >= kMostPictured) {
        point.clear_histograms();
        point.clear_curves();
      }
      points.json.push_back(Json(point));
    }
    token = page->next_page_token();
  } while (!token.empty());
  return points;
}

absl::StatusOr<std::string> JobJson(const Connection& connection, const std::string& name) {
  const absl::StatusOr<Points> points = PointsOf(connection, name);
  if (!points.ok()) return points.status();
  // Fetched after the points, so that its count includes all of them.
  const auto job = connection.client.Get(name);
  if (!job.ok()) return job.status();
  const int64_t left_out = points->is_complete ? 0
                                               : job->progress().points_done() -
                                                     static_cast<int64_t>(points->json.size());
  return absl::StrCat("{\"job\":", Json(*job), ",\"points\":[", absl::StrJoin(points->json, ",\n"),
                      "],\"points_left_out\":", left_out, "}");
}

absl::StatusOr<std::string> Data(const Connection& connection,
                                 const std::vector<std::string>& names) {
  std::vector<std::string> jobs;
  for (const std::string& name : names) {
    const auto job = JobJson(connection, name);
    if (!job.ok()) return job.status();
    jobs.push_back(*job);
  }
  return absl::StrCat("{\"client_version\":\"", BALLPISTON_VERSION, "\",\"created\":\"",
                      absl::FormatTime(absl::RFC3339_sec, absl::Now(), absl::UTCTimeZone()),
                      "\",\"jobs\":[", absl::StrJoin(jobs, ",\n"), "]}");
}

}  // namespace

VerbResult ReportJobs(const Options& options, Terminal& terminal) {
  if (options.out.empty()) {
    return absl::InvalidArgumentError("--out is missing: name the HTML file to write");
  }
  if (absl::Status bad = CheckNewFile("--out", options.out); !bad.ok()) return bad;
  const auto files = ReadPageFiles();
  if (!files.ok()) return files.status();
  return WithJobs(options, terminal, {},
                  [&](const auto& connection, const auto& names) -> VerbResult {
                    const auto data = Data(connection, names);
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
