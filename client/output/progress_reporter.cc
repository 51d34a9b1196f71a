#include "client/output/progress_reporter.h"

#include <google/protobuf/struct.pb.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "absl/time/clock.h"
#include "client/library/quoted.h"
#include "client/output/json.h"
#include "client/output/number_text.h"
#include "client/output/progress_line.h"
#include "client/output/progress_meter.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

constexpr size_t kUsualWidth = 80;

size_t TerminalWidth() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUsualWidth;
  return size.ws_col;
}

// The server sends unfinished points newest first, and finished ones in the order of finishing.
template <typename Visit>
void ForEachNewestFirst(const v1::StatisticsSnapshot& snapshot, Visit visit) {
  for (const v1::PointResult& point : snapshot.points()) visit(point);
  const auto& finished = snapshot.finished_points();
  std::for_each(finished.rbegin(), finished.rend(), visit);
}

// Null if none changed.
const v1::PointResult* NewestPoint(const v1::StatisticsSnapshot& snapshot) {
  if (!snapshot.points().empty()) return &snapshot.points(0);
  const auto& finished = snapshot.finished_points();
  return finished.empty() ? nullptr : &*finished.rbegin();
}

class Silence : public ProgressReporter {
 public:
  explicit Silence(std::ostream& err) : err_(err) {}

  void OnJob(const v1::EnsembleJob&) override {}
  void OnSnapshot(const v1::StatisticsSnapshot&) override {}
  void OnDisconnect(const absl::Status&, absl::Duration) override {}
  void OnEnd() override {}
  void Note(absl::string_view text) override {
    const std::lock_guard lock(mutex_);
    err_ << text << '\n' << std::flush;
  }

 private:
  std::mutex mutex_;
  std::ostream& err_;
};

class BarReporter : public ProgressReporter {
 public:
  explicit BarReporter(std::ostream& err) : err_(err) {}

  void OnJob(const v1::EnsembleJob& job) override {
    const std::lock_guard lock(mutex_);
    if (name_.empty()) WriteLine(job.name());
    name_ = job.name();
    state_ = job.state();
    work_ = job.work();
    meter_.Update(job.progress(), absl::Now());
    Draw();
  }

  void OnSnapshot(const v1::StatisticsSnapshot& snapshot) override {
    const std::lock_guard lock(mutex_);
    meter_.Update(snapshot.progress(), absl::Now());
    if (const v1::PointResult* newest = NewestPoint(snapshot)) point_ = *newest;
    Draw();
  }

  void OnDisconnect(const absl::Status&, absl::Duration pause) override {
    const std::lock_guard lock(mutex_);
    Redraw(
        absl::StrFormat("connection lost, trying again in %.1f s", absl::ToDoubleSeconds(pause)));
  }

  void OnEnd() override {
    const std::lock_guard lock(mutex_);
    if (name_.empty()) return;
    WriteLine(absl::StrFormat("%s: %d of %d points, %.6g samples%s", Spelling(state_),
                              meter_.progress().points_done(), meter_.progress().points(),
                              meter_.progress().samples(), WorkText()));
  }

  void Note(absl::string_view text) override {
    const std::lock_guard lock(mutex_);
    WriteLine(text);
  }

 private:
  // In a plan's words; a server that was started again does not know of the work before.
  std::string WorkText() const {
    return work_ == 0 ? "" : absl::StrCat(", ", DurationText(work_), " of one core");
  }

  // One column stays free: some terminals wrap when the last one is written.
  void Draw() { Redraw(ProgressLine(meter_, point_, TerminalWidth() - 1)); }
  void Redraw(absl::string_view line) { err_ << '\r' << line << "\x1b[K" << std::flush; }
  void WriteLine(absl::string_view line) {
    Redraw(line);
    err_ << '\n' << std::flush;
  }

  std::mutex mutex_;
  std::ostream& err_;
  std::string name_;
  v1::EnsembleJob::State state_ = v1::EnsembleJob::STATE_UNSPECIFIED;
  double work_ = 0;  // seconds of one core
  ProgressMeter meter_;
  std::optional<v1::PointResult> point_;
};

std::string NumberOrNull(std::optional<double> x) {
  return x ? absl::StrFormat("%.6g", *x) : "null";
}

class JsonReporter : public ProgressReporter {
 public:
  JsonReporter(std::ostream& err, absl::string_view name) : err_(err), name_(name) {}

  void OnJob(const v1::EnsembleJob& job) override {
    const std::lock_guard lock(mutex_);
    name_ = job.name();
    state_ = job.state();
    meter_.Update(job.progress(), absl::Now());
    Write("");
  }

  void OnSnapshot(const v1::StatisticsSnapshot& snapshot) override {
    const std::lock_guard lock(mutex_);
    meter_.Update(snapshot.progress(), absl::Now());
    std::string points;
    ForEachNewestFirst(snapshot, [&points](const v1::PointResult& point) {
      absl::StrAppend(&points, points.empty() ? "" : ", ", Json(point));
    });
    Write(points);
  }

  void OnDisconnect(const absl::Status&, absl::Duration) override {}
  void OnEnd() override {}

  void Note(absl::string_view text) override {
    google::protobuf::Value note;
    note.set_string_value(std::string(text));
    const std::lock_guard lock(mutex_);
    err_ << "{\"note\": " << Json(note) << "}\n" << std::flush;
  }

 private:
  void Write(absl::string_view points) {
    std::optional<double> left;
    if (const auto time = meter_.TimeLeft()) left = absl::ToDoubleSeconds(*time);
    err_ << "{\"job\": \"" << name_ << "\", \"state\": \"" << v1::EnsembleJob::State_Name(state_)
         << "\", \"progress\": " << Json(meter_.progress())
         << ", \"samples_per_second\": " << NumberOrNull(meter_.SamplesPerSecond())
         << ", \"seconds_left\": " << NumberOrNull(left) << ", \"points\": [" << points << "]}\n"
         << std::flush;
  }

  std::mutex mutex_;
  std::ostream& err_;
  std::string name_;
  v1::EnsembleJob::State state_ = v1::EnsembleJob::STATE_UNSPECIFIED;
  ProgressMeter meter_;
};

}  // namespace

absl::StatusOr<ProgressStyle> ParseProgressStyle(absl::string_view text) {
  if (text == "auto") return isatty(STDERR_FILENO) ? ProgressStyle::kBar : ProgressStyle::kNone;
  if (text == "bar") return ProgressStyle::kBar;
  if (text == "json") return ProgressStyle::kJson;
  if (text == "none") return ProgressStyle::kNone;
  return absl::InvalidArgumentError(
      absl::StrCat("--progress: ", Quoted(text), " is not one of auto, bar, json, none"));
}

std::unique_ptr<ProgressReporter> NewProgressReporter(ProgressStyle style, std::ostream& err,
                                                      absl::string_view name) {
  switch (style) {
    case ProgressStyle::kBar:
      return std::make_unique<BarReporter>(err);
    case ProgressStyle::kJson:
      return std::make_unique<JsonReporter>(err, name);
    case ProgressStyle::kNone:
      break;
  }
  return std::make_unique<Silence>(err);
}

}  // namespace ballpiston::client
