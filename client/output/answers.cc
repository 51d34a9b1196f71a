#include "client/output/answers.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/output/json.h"
#include "client/output/number_text.h"
#include "client/output/spelling.h"
#include "client/output/table.h"

namespace ballpiston::client {
namespace {

// ---- the closed forms ----

Cells KernelTitles(const std::vector<double>& outgoing) {
  Cells titles;
  for (const double energy : outgoing) titles.push_back(absl::StrCat("W(", ExactText(energy), ")"));
  return titles;
}

void PrintCsv(const v1::EvaluatePairsResponse& response, const std::vector<double>& outgoing,
              std::ostream& out) {
  const Cells pairs = PlainFields(*v1::PairAnalytics::descriptor()),
              energies = PlainFields(*v1::EnergyAnalytics::descriptor()),
              averages = PlainFields(*v1::CanonicalAnalytics::descriptor());
  const Cells no_energy(energies.size() + outgoing.size()), no_averages(averages.size());
  out << CsvRow(Joined({pairs, energies, KernelTitles(outgoing), averages}));
  for (const v1::PairAnalytics& pair : response.points()) {
    const Cells cells = FieldTexts(pair, pairs);
    if (pair.energies().empty() && pair.canonical().empty()) {
      out << CsvRow(Joined({cells, no_energy, no_averages}));
    }
    for (const auto& energy : pair.energies()) {
      Cells kernel;
      for (const double w : energy.kernel()) kernel.push_back(ExactText(w));
      out << CsvRow(Joined({cells, FieldTexts(energy, energies), kernel, no_averages}));
    }
    for (const auto& row : pair.canonical()) {
      out << CsvRow(Joined({cells, no_energy, FieldTexts(row, averages)}));
    }
  }
}

std::string TableCell(double x) { return Measured(x, 0).value; }

std::string ParameterCell(double x) { return Digits(x, 12); }

Cells TableCells(const google::protobuf::Message& row, const Cells& columns) {
  Cells cells;
  for (const std::string& name : columns) {
    const bool is_parameter = v1::PointParameters::descriptor()->FindFieldByName(name) != nullptr;
    cells.push_back(FieldText(row, name, is_parameter ? &ParameterCell : &TableCell));
  }
  return cells;
}

void PrintQuantities(const v1::PairAnalytics& pair, std::ostream& out) {
  TextTable table({"quantity", "value"}, {"quantity", "value"});
  const Cells names = PlainFields(*v1::PairAnalytics::descriptor()),
              values = TableCells(pair, names);
  for (size_t i = 0; i < names.size(); ++i) table.AddRow({names[i], values[i]});
  table.Print(out);
}

// A row for each message, with its kernel if it has one.
template <typename Rows>
void PrintRows(const Rows& rows, const Cells& kernel_titles, std::ostream& out) {
  if (rows.empty()) return;
  const Cells columns = PlainFields(*rows[0].GetDescriptor());
  TextTable table(Joined({columns, kernel_titles}));
  for (const auto& row : rows) {
    Cells cells = TableCells(row, columns);
    if constexpr (requires { row.kernel(); }) {
      for (const double w : row.kernel()) cells.push_back(TableCell(w));
    }
    table.AddRow(cells);
  }
  out << '\n';
  table.Print(out, 2);
}

void PrintTable(const v1::EvaluatePairsResponse& response, const std::vector<double>& outgoing,
                std::ostream& out) {
  const char* separator = "";
  for (const v1::PairAnalytics& pair : response.points()) {
    out << separator;
    separator = "\n";
    PrintQuantities(pair, out);
    PrintRows(pair.energies(), KernelTitles(outgoing), out);
    PrintRows(pair.canonical(), {}, out);
  }
}

// ---- jobs ----

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

// ---- a server's status ----

// 68 KiB, 1.2 GiB.
std::string BytesText(double bytes) {
  const char* const units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  size_t unit = 0;
  for (; bytes >= 1023.5 && unit + 1 < std::size(units); ++unit) bytes /= 1024;
  return absl::StrFormat("%.*f %s", unit > 0 && bytes < 9.95 ? 1 : 0, bytes, units[unit]);
}

std::string CountText(double count) {
  return count < 1e7 ? ExactText(count) : absl::StrFormat("%.3g", count);
}

std::string DaysText(double days) { return Counted(days, "day"); }

std::string LimitText(double limit, std::string (*text)(double) = &CountText) {
  return limit == 0 ? "no limit" : text(limit);
}

// A time per operation as a rate per second: 490 million.
std::string SpeedText(double seconds) {
  if (seconds <= 0) return "?";
  const double rate = 1 / seconds;
  return rate >= 1e6 ? absl::StrFormat("%.3g million", rate / 1e6) : absl::StrFormat("%.3g", rate);
}

std::string Started(const v1::ServerStatus& status, absl::Time now) {
  const absl::Time start = absl::FromUnixSeconds(status.start_time().seconds());
  const double up = std::max(0.0, absl::ToDoubleSeconds(now - start));  // clocks may differ
  return absl::StrCat(FieldText(status, "start_time"), ", ", DurationText(up), " ago");
}

std::string Computed(const v1::ServerStatus& status) {
  return absl::StrCat(CountText(status.samples_computed()), " samples in ",
                      CountText(status.blocks_computed()), " blocks, ",
                      DurationText(status.processor_seconds()), " of processor time");
}

std::string Expiring(double jobs) {
  return absl::StrCat("results of ", Counted(jobs, "job"), " expire within a week");
}

std::string Speed(const v1::ComputingRates& rates) {
  return absl::StrCat(SpeedText(rates.wall_hit()), " wall hits/s, ", SpeedText(rates.jump()),
                      " jumps/s per core");
}

std::string ClusterText(const v1::ClusterStatus& cluster) {
  std::string text = absl::StrCat(Counted(cluster.taken_leases(), "lease"), " taken, ",
                                  CountText(cluster.waiting_leases()), " waiting");
  const double workers = cluster.running_workers() + cluster.waiting_workers();
  if (workers > 0) {
    absl::StrAppend(&text, "; ", CountText(cluster.running_workers()), " workers run, ",
                    CountText(cluster.waiting_workers()), " wait");
  }
  return cluster.problem().empty() ? text : absl::StrCat(text, "; ", cluster.problem());
}

void PrintServer(const v1::ServerStatus& status, absl::Time now, std::ostream& out) {
  TextTable table({"server", status.version()}, {"server", status.version()});
  table.AddRow({"engine", status.engine_version()});
  table.AddRow({"state", Spelling(status.state())});
  table.AddRow({"started", Started(status, now)});
  table.AddRow({"you", absl::StrCat(status.principal(), ", role ", status.role())});
  table.AddRow({"jobs", absl::StrCat(CountText(status.queued_jobs()), " queued, ",
                                     CountText(status.running_jobs()), " running, ",
                                     CountText(status.stored_jobs()), " in the store")});
  table.AddRow({"workers", absl::StrCat(status.busy_workers(), " of ", status.workers(), " busy")});
  if (status.has_cluster()) table.AddRow({"cluster", ClusterText(status.cluster())});
  table.AddRow({"computed", Computed(status)});
  if (status.has_rates()) table.AddRow({"speed", Speed(status.rates())});
  table.AddRow({"streams", CountText(status.streams())});
  table.AddRow({"store", BytesText(status.store_bytes())});
  if (status.expiring_jobs() > 0) table.AddRow({"expiry", Expiring(status.expiring_jobs())});
  table.Print(out);
}

void PrintLimits(const v1::ServerLimits& limits, std::ostream& out) {
  TextTable table({"limit", "most"}, {"limit"});
  table.AddRow({"points of a job", LimitText(limits.max_points_per_job())});
  table.AddRow({"active jobs of a principal", LimitText(limits.max_active_jobs_per_principal())});
  table.AddRow(
      {"active points of a principal", LimitText(limits.max_active_points_per_principal())});
  table.AddRow({"streams of a principal", LimitText(limits.max_streams_per_principal())});
  table.AddRow({"results kept", LimitText(limits.retain_days(), &DaysText)});
  out << '\n';
  table.Print(out);
}

void PrintPrincipals(const v1::ServerStatus& status, std::ostream& out) {
  if (status.principals().empty()) return;
  TextTable table({"principal", "queued", "running", "streams", "stored", "stored bytes"},
                  {"principal"});
  for (const v1::PrincipalStatus& principal : status.principals()) {
    table.AddRow({principal.principal(), CountText(principal.queued_jobs()),
                  CountText(principal.running_jobs()), CountText(principal.streams()),
                  CountText(principal.stored_jobs()), BytesText(principal.stored_bytes())});
  }
  out << '\n';
  table.Print(out);
}

void PrintCsv(const v1::ServerStatus& status, std::ostream& out) {
  const Cells names = PlainFields(*v1::ServerStatus::descriptor());
  out << CsvRow(names) << CsvRow(FieldTexts(status, names));
}

}  // namespace

void PrintAnalytics(const v1::EvaluatePairsResponse& response,
                    const std::vector<double>& outgoing_epsilon, Format format, std::ostream& out) {
  if (format == Format::kTable) return PrintTable(response, outgoing_epsilon, out);
  if (format == Format::kCsv) return PrintCsv(response, outgoing_epsilon, out);
  if (format == Format::kJsonl) return PrintJsonLines(response.points(), out);
  PrintJsonDocument("points", response.points(), out);
}

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

void PrintStatus(const v1::ServerStatus& status, absl::Time now, Format format, std::ostream& out) {
  if (format == Format::kCsv) return PrintCsv(status, out);
  if (format != Format::kTable) {
    out << Json(status) << '\n';
    return;
  }
  PrintServer(status, now, out);
  PrintPrincipals(status, out);
  if (status.has_limits()) PrintLimits(status.limits(), out);
}

}  // namespace ballpiston::client
