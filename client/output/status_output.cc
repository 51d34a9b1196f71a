#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/output/answers.h"
#include "client/output/field_text.h"
#include "client/output/json.h"
#include "client/output/spelling.h"
#include "client/output/text_table.h"

namespace ballpiston::client {
namespace {

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
