#include "client/output/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "client/output/json.h"
#include "client/output/number_text.h"
#include "client/output/spelling.h"
#include "client/output/table.h"

namespace ballpiston::client {
namespace {

constexpr size_t kWidestBar = 30;
constexpr size_t kNarrowestBar = 6;

// [####----], `width` characters wide.
std::string Bar(double fraction, size_t width) {
  const size_t inside = width - 2;
  const double filled = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(inside);
  const auto marks = static_cast<size_t>(filled);
  return absl::StrCat("[", std::string(marks, '#'), std::string(inside - marks, '-'), "]");
}

// 1.4e5: shorter than printf's 1.4e+05.
std::string Rate(double rate) {
  return absl::StrCat(
      absl::StrReplaceAll(absl::StrFormat("%.2g", rate), {{"e+0", "e"}, {"e+", "e"}}),
      " samples/s");
}

// Uses the short names of the closed forms: tau_ball_piston for mean_free_time_ball_piston.
std::string Estimate(const v1::Estimate& estimate) {
  const std::optional<double> error = NumberIn(estimate, "standard_error");
  const MeasuredText text = Measured(estimate.value(), error);
  return absl::StrCat(absl::StrReplaceAll(estimate.name(), {{"mean_free_time", "tau"}}), " ",
                      text.value, error ? " +- " : "", text.error);
}

// All but rho, with short names: (delta 0.1 epsilon 0.25 n 1).
std::string Parameters(const v1::PointParameters& parameters) {
  const NumberForm four_digits = [](double x) { return absl::StrFormat("%.4g", x); };
  Cells texts;
  for (const std::string& name : FieldNames(*v1::PointParameters::descriptor())) {
    const std::string value = FieldText(parameters, name, four_digits);
    if (name == "rho" || value.empty()) continue;
    texts.push_back(absl::StrCat(
        absl::StrReplaceAll(name, {{"exponent", "n"}, {"temperature", "T"}}), " ", value));
  }
  return absl::StrCat("(", absl::StrJoin(texts, " "), ")");
}

constexpr char kClearLine[] = "\r\x1b[K";

size_t TerminalWidth() {
  constexpr size_t kUsualWidth = 80;
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUsualWidth;
  return size.ws_col;
}

ProgressStyle Resolved(ProgressStyle style) {
  if (style != ProgressStyle::kAuto) return style;
  return HasTerminal() ? ProgressStyle::kBar : ProgressStyle::kNone;
}

// The time of a clock that cannot be set. The clock stops while the machine sleeps.
absl::Time Now() {
  return absl::UnixEpoch() + absl::FromChrono(std::chrono::steady_clock::now().time_since_epoch());
}

// The work of a job, written as in a plan. A restarted server does not know the earlier work.
std::string WorkText(double work) {
  return work == 0 ? "" : absl::StrCat(", ", DurationText(work), " of one core");
}

}  // namespace

double ProgressMeter::FractionOf(const v1::JobProgress& progress) {
  if (progress.has_fraction()) return progress.fraction();
  if (progress.points() == 0) return 0;
  return static_cast<double>(progress.points_done()) / progress.points();
}

void ProgressMeter::Update(const v1::JobProgress& progress, absl::Time now) {
  now_ = {progress, now};
  // Nothing was computed since the first reading: the job waits in the queue, or a server died and
  // lost the samples since its last checkpoint. The means start again.
  const auto work = [](const v1::JobProgress& p) { return std::pair(p.samples(), FractionOf(p)); };
  if (!first_ || work(progress) <= work(first_->progress)) first_ = now_;
}

std::optional<double> ProgressMeter::SamplesPerSecond() const {
  if (!first_ || now_.time <= first_->time) return std::nullopt;
  const double samples = now_.progress.samples() - first_->progress.samples();
  if (samples <= 0) return std::nullopt;
  return samples / absl::ToDoubleSeconds(now_.time - first_->time);
}

std::optional<absl::Duration> ProgressMeter::TimeLeft() const {
  if (!first_) return std::nullopt;
  const double done = Fraction() - FractionOf(first_->progress);
  if (done <= 0) return std::nullopt;
  return (now_.time - first_->time) * ((1 - Fraction()) / done);
}

std::string ProgressLine(const ProgressMeter& meter,
                         const std::optional<v1::PointResult>& point_in_work, size_t width) {
  std::vector<std::string> parts = {
      absl::StrFormat("%d/%d points", meter.progress().points_done(), meter.progress().points())};
  if (const auto rate = meter.SamplesPerSecond()) parts.push_back(Rate(*rate));
  if (const auto left = meter.TimeLeft()) parts.push_back(ClockText(*left) + " left");
  if (point_in_work && !point_in_work->estimates().empty()) {
    parts.push_back(Estimate(point_in_work->estimates(0)));
    parts.push_back(Parameters(point_in_work->parameters()));
  }
  std::string line = parts[0].substr(0, width);
  for (size_t i = 1; i < parts.size(); ++i) {
    if (line.size() + 2 + parts[i].size() > width) break;
    absl::StrAppend(&line, "  ", parts[i]);
  }
  if (line.size() + 1 + kNarrowestBar > width) return line;
  return absl::StrCat(Bar(meter.Fraction(), std::min(width - line.size() - 1, kWidestBar)), " ",
                      line);
}

bool HasTerminal() {
  const char* const terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) && terminal != nullptr && std::strcmp(terminal, "dumb") != 0;
}

ProgressReporter::ProgressReporter(ProgressStyle style, std::ostream& err, absl::string_view name)
    : style_(Resolved(style)), err_(err) {
  job_.set_name(std::string(name));
}

void ProgressReporter::OnJob(const v1::EnsembleJob& job) {
  const std::lock_guard lock(mutex_);
  if (style_ == ProgressStyle::kBar && !named_) WriteLines(job.name());
  named_ = true;
  job_ = job;
  meter_.Update(job.progress(), Now());
  Show({});
}

void ProgressReporter::OnSnapshot(const v1::StatisticsSnapshot& snapshot) {
  const std::lock_guard lock(mutex_);
  meter_.Update(snapshot.progress(), Now());
  // The points of an ended job come before the message that has its state, and a snapshot may come
  // before the message that the job has begun.
  const bool has_begun = snapshot.progress().points_done() > 0 || snapshot.progress().samples() > 0;
  if (has_begun && job_.state() <= v1::EnsembleJob::QUEUED) {
    job_.set_state(v1::EnsembleJob::RUNNING);
  }
  if (!snapshot.finished_points().empty()) point_ = *snapshot.finished_points().rbegin();
  if (!snapshot.points().empty()) point_ = snapshot.points(0);
  Show(snapshot);
}

void ProgressReporter::OnDisconnect(const absl::Status& why, absl::Duration pause) {
  const std::lock_guard lock(mutex_);
  if (style_ != ProgressStyle::kBar) return;
  const char* const what = absl::IsResourceExhausted(why) ? "server busy" : "connection lost";
  err_ << kClearLine
       << absl::StrFormat("%s, retrying in %.1f s", what, absl::ToDoubleSeconds(pause))
       << std::flush;
  drawn_ = true;
}

void ProgressReporter::OnEnd() {
  const std::lock_guard lock(mutex_);
  if (style_ != ProgressStyle::kBar || !named_) return;
  WriteLines(absl::StrFormat("%s: %d of %d points, %.6g samples%s", Spelling(job_.state()),
                             meter_.progress().points_done(), meter_.progress().points(),
                             meter_.progress().samples(), WorkText(job_.work())));
}

void ProgressReporter::Note(absl::string_view text) {
  const std::lock_guard lock(mutex_);
  WriteLines(text);
}

// Does not release the lock. Another thread may hold it while it writes to a stopped terminal.
void ProgressReporter::Farewell(absl::string_view text) {
  if (mutex_.try_lock_for(std::chrono::milliseconds(100))) WriteLines(text);
}

void ProgressReporter::Show(const v1::StatisticsSnapshot& changes) {
  if (style_ == ProgressStyle::kJson) WriteJson(changes, "");
  if (style_ != ProgressStyle::kBar) return;
  // Some terminals wrap after the last column, and terminals print ^C for each Ctrl-C. The free
  // columns prevent a second line, which could not be cleared.
  constexpr size_t kFreeColumns = 5;
  err_ << '\r'
       << ProgressLine(meter_, point_, std::max(TerminalWidth(), kFreeColumns + 1) - kFreeColumns)
       << "\x1b[K" << std::flush;
  drawn_ = true;
}

// The server sends unfinished points newest first, and finished points in the order of finishing.
void ProgressReporter::WriteJson(const v1::StatisticsSnapshot& changes, absl::string_view note) {
  file::v1::WatchProgress line;
  line.set_job(job_.name());
  if (job_.state() != v1::EnsembleJob::STATE_UNSPECIFIED) line.set_state(job_.state());
  *line.mutable_progress() = meter_.progress();
  if (const auto rate = meter_.SamplesPerSecond()) line.set_samples_per_second(*rate);
  if (const auto left = meter_.TimeLeft()) line.set_seconds_left(absl::ToDoubleSeconds(*left));
  *line.mutable_points() = changes.points();
  const auto& finished = changes.finished_points();
  std::for_each(finished.rbegin(), finished.rend(),
                [&](const v1::PointResult& point) { *line.add_points() = point; });
  for (v1::PointResult& point : *line.mutable_points()) point.clear_name();
  line.set_note(std::string(note));
  err_ << Json(line) << '\n' << std::flush;
}

void ProgressReporter::WriteLines(absl::string_view text) {
  if (style_ == ProgressStyle::kJson) return WriteJson({}, text);
  err_ << (drawn_ ? kClearLine : "") << text << '\n' << std::flush;
  drawn_ = false;
}

}  // namespace ballpiston::client
