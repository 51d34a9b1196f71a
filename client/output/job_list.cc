#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "client/output/answers.h"
#include "client/output/field_text.h"
#include "client/output/json.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

// The columns of every list, and those that CSV has too. Their titles in CSV are the last names.
const Cells kFields = {"name",
                       "spec.experiment",
                       "state",
                       "progress.points_done",
                       "progress.points",
                       "progress.samples",
                       "create_time",
                       "end_time"};
const Cells kMoreInCsv = {"principal",       "priority",     "pinned",   "expire_time",
                          "results_expired", "stored_bytes", "continues"};

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

void PrintCsv(const std::vector<v1::EnsembleJob>& jobs, std::ostream& out) {
  const Cells fields = Joined({kFields, kMoreInCsv});
  Cells titles;
  for (const std::string& field : fields) titles.push_back(field.substr(field.rfind('.') + 1));
  out << CsvRow(Joined({titles, {"labels"}}));
  for (const v1::EnsembleJob& job : jobs) {
    out << CsvRow(Joined({FieldTexts(job, fields), {LabelsText(job)}}));
  }
}

void PrintTable(const std::vector<v1::EnsembleJob>& jobs, absl::Time now, std::ostream& out) {
  const bool has_principals = std::any_of(jobs.begin(), jobs.end(), [&](const auto& job) {
    return job.principal() != jobs.front().principal();
  });
  const bool has_priorities =
      std::any_of(jobs.begin(), jobs.end(), [](const auto& job) { return job.priority() != 0; });
  TextTable table(
      {"name", "experiment", "state", "done", "points", "samples", "created", "ended", "principal",
       "priority", "results", "labels"},
      {"name", "experiment", "state", "created", "ended", "principal", "results", "labels"},
      {"principal", "priority", "results", "labels"});
  for (const v1::EnsembleJob& job : jobs) {
    table.AddRow(Joined(
        {FieldTexts(job, kFields),
         {has_principals ? job.principal() : "", has_priorities ? absl::StrCat(job.priority()) : "",
          ResultsText(job, now), LabelsText(job)}}));
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
  if (format == Format::kTable) return PrintTable(jobs, now, out);
  if (format == Format::kCsv) return PrintCsv(jobs, out);
  if (format == Format::kJsonl) return PrintJsonLines(jobs, out);
  PrintJsonDocument("jobs", jobs, out);
}

}  // namespace ballpiston::client
