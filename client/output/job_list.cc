#include "client/output/job_list.h"

#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "client/output/csv_row.h"
#include "client/output/json.h"
#include "client/output/number_text.h"
#include "client/output/spelling.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

std::string TimeText(bool present, const google::protobuf::Timestamp& time) {
  if (!present) return "";
  const absl::Time instant = absl::FromUnixSeconds(time.seconds());
  return absl::FormatTime("%Y-%m-%dT%H:%M:%SZ", instant, absl::UTCTimeZone());
}

std::vector<std::string> CellsOf(const v1::EnsembleJob& job) {
  return {job.name(),
          Spelling(job.spec().experiment()),
          Spelling(job.state()),
          absl::StrCat(job.progress().points_done()),
          absl::StrCat(job.progress().points()),
          ExactText(job.progress().samples()),
          TimeText(job.has_create_time(), job.create_time()),
          TimeText(job.has_end_time(), job.end_time())};
}

// "expires in 3 days", "expires in 5 hours": the remaining time, rounded down.
std::string ExpiryText(absl::Duration left) {
  const double hours = std::floor(absl::ToDoubleHours(left));
  if (hours < 1) return "expires within an hour";
  if (hours < 24) return absl::StrCat("expires in ", Counted(hours, "hour"));
  return absl::StrCat("expires in ", Counted(std::floor(hours / 24), "day"));
}

// The cell in the column `results`; empty if the results are kept for more than a week.
std::string ResultsText(const v1::EnsembleJob& job, absl::Time now) {
  constexpr absl::Duration kSoon = absl::Hours(7 * 24);
  if (job.results_expired()) return "expired";
  if (job.pinned()) return "pinned";
  const absl::Duration left = absl::FromUnixSeconds(job.expire_time().seconds()) - now;
  return job.has_expire_time() && left <= kSoon ? ExpiryText(left) : "";
}

// The optional columns that the table needs.
struct Differences {
  bool principals = false;
  bool priorities = false;
  bool results = false;
  bool labels = false;
};

Differences DifferencesOf(const std::vector<v1::EnsembleJob>& jobs, absl::Time now) {
  Differences differ;
  for (const v1::EnsembleJob& job : jobs) {
    differ.principals |= job.principal() != jobs.front().principal();
    differ.priorities |= job.priority() != 0;
    differ.results |= !ResultsText(job, now).empty();
    differ.labels |= !job.labels().empty();
  }
  return differ;
}

void PrintCsv(const std::vector<v1::EnsembleJob>& jobs, std::ostream& out) {
  out << "name,experiment,state,points_done,points,samples,create_time,end_time,principal,"
         "priority,pinned,expire_time,results_expired,stored_bytes,labels\n";
  for (const v1::EnsembleJob& job : jobs) {
    std::vector<std::string> cells = CellsOf(job);
    cells.push_back(job.principal());  // it may hold any character
    const auto truth = [](bool holds) { return holds ? "true" : "false"; };
    cells.insert(cells.end(),
                 {absl::StrCat(job.priority()), truth(job.pinned()),
                  TimeText(job.has_expire_time(), job.expire_time()), truth(job.results_expired()),
                  ExactText(job.stored_bytes()), LabelsText(job)});
    out << CsvRow(cells);
  }
}

void PrintTable(const std::vector<v1::EnsembleJob>& jobs, absl::Time now, std::ostream& out) {
  constexpr auto kLeft = TextTable::Column::kLeft;
  const Differences differ = DifferencesOf(jobs, now);
  std::vector<TextTable::Column> columns = {
      {"name", kLeft}, {"experiment", kLeft}, {"state", kLeft},   {"done"},
      {"points"},      {"samples"},           {"created", kLeft}, {"ended", kLeft}};
  if (differ.principals) columns.push_back({"principal", kLeft});
  if (differ.priorities) columns.push_back({"priority"});
  if (differ.results) columns.push_back({"results", kLeft});
  if (differ.labels) columns.push_back({"labels", kLeft});
  TextTable table(std::move(columns));
  for (const v1::EnsembleJob& job : jobs) {
    std::vector<std::string> cells = CellsOf(job);
    if (differ.principals) cells.push_back(job.principal());
    if (differ.priorities) cells.push_back(absl::StrCat(job.priority()));
    if (differ.results) cells.push_back(ResultsText(job, now));
    if (differ.labels) cells.push_back(LabelsText(job));
    table.AddRow(std::move(cells));
  }
  table.Print(out);
}

}  // namespace

std::string LabelsText(const v1::EnsembleJob& job) {
  const std::map<std::string, std::string> labels(job.labels().begin(), job.labels().end());
  return absl::StrJoin(labels, " ", absl::PairFormatter("="));
}

void PrintJobs(const std::vector<v1::EnsembleJob>& jobs, absl::Time now, Format format,
               std::ostream& out) {
  switch (format) {
    case Format::kTable:
      return PrintTable(jobs, now, out);
    case Format::kJson:
      return PrintJsonDocument("jobs", jobs, out);
    case Format::kJsonl:
      return PrintJsonLines(jobs, out);
    case Format::kCsv:
    case Format::kCsvHistograms:
    case Format::kCsvCurves:
      return PrintCsv(jobs, out);
  }
}

v1::ListEnsembleJobsRequest::View JobViewFor(Format format) {
  const bool is_json = format == Format::kJson || format == Format::kJsonl;
  return is_json ? v1::ListEnsembleJobsRequest::FULL : v1::ListEnsembleJobsRequest::BASIC;
}

}  // namespace ballpiston::client
