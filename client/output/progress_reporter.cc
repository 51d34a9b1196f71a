#include "client/output/progress_reporter.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "client/output/json.h"
#include "client/output/number_text.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

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
