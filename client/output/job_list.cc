#include "client/output/job_list.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
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

// Whether the jobs differ in whose they are, or in their priority.
struct Differences {
  bool principals = false;
  bool priorities = false;
};

Differences DifferencesOf(const std::vector<v1::EnsembleJob>& jobs) {
  Differences differ;
  for (const v1::EnsembleJob& job : jobs) {
    differ.principals |= job.principal() != jobs.front().principal();
    differ.priorities |= job.priority() != 0;
  }
  return differ;
}

void PrintCsv(const std::vector<v1::EnsembleJob>& jobs, std::ostream& out) {
  out << "name,experiment,state,points_done,points,samples,create_time,end_time,principal,"
         "priority\n";
  for (const v1::EnsembleJob& job : jobs) {
    std::vector<std::string> cells = CellsOf(job);
    cells.push_back(job.principal());  // it may hold any character
    cells.push_back(absl::StrCat(job.priority()));
    out << CsvRow(cells);
  }
}

void PrintTable(const std::vector<v1::EnsembleJob>& jobs, std::ostream& out) {
  constexpr auto kLeft = TextTable::Column::kLeft;
  const Differences differ = DifferencesOf(jobs);
  std::vector<TextTable::Column> columns = {
      {"name", kLeft}, {"experiment", kLeft}, {"state", kLeft},   {"done"},
      {"points"},      {"samples"},           {"created", kLeft}, {"ended", kLeft}};
  if (differ.principals) columns.push_back({"principal", kLeft});
  if (differ.priorities) columns.push_back({"priority"});
  TextTable table(std::move(columns));
  for (const v1::EnsembleJob& job : jobs) {
    std::vector<std::string> cells = CellsOf(job);
    if (differ.principals) cells.push_back(job.principal());
    if (differ.priorities) cells.push_back(absl::StrCat(job.priority()));
    table.AddRow(std::move(cells));
  }
  table.Print(out);
}

}  // namespace

void PrintJobs(const std::vector<v1::EnsembleJob>& jobs, Format format, std::ostream& out) {
  switch (format) {
    case Format::kTable:
      return PrintTable(jobs, out);
    case Format::kJson:
      return PrintJsonDocument("jobs", jobs, out);
    case Format::kJsonl:
      return PrintJsonLines(jobs, out);
    case Format::kCsv:
      return PrintCsv(jobs, out);
  }
}

}  // namespace ballpiston::client
