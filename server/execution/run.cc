#include "server/execution/run.h"

#include <utility>

namespace ballpiston::server {

Run::Run(RunRequest request) : request_(std::move(request)), shortfall_(request_.shortfall) {
  SkipFinishedPoints();
}

void Run::SkipFinishedPoints() {
  while (next_point_ < request_.finished.size() && request_.finished[next_point_]) ++next_point_;
}

std::optional<RunTask> Run::NextTask() {
  if (stopped_) return std::nullopt;
  std::optional<RunTask> task = NextOfOpenPoints();
  if (!task) task = NextPoint();
  if (task) ++tasks_out_;
  return task;
}

std::optional<RunTask> Run::NextOfOpenPoints() {
  for (const auto& [index, point] : open_) {
    if (point->fold.finished()) continue;  // it is about to be closed
    SessionTask task = {index, nullptr, point->experiment, point->stop.get_token()};
    if (!point->resting.empty()) {
      task.session = std::move(point->resting.front());
      point->resting.pop_front();
      return task;
    }
    if (point->fold.HasNextBlock()) return task;
  }
  return std::nullopt;
}

std::optional<RunTask> Run::NextPoint() {
  if (opening_ || next_point_ == request_.finished.size()) return std::nullopt;
  opening_ = true;
  const size_t point = next_point_++;
  SkipFinishedPoints();
  return OpenPointTask{point, stop_opening_.get_token()};
}

void Run::TaskDone(const RunTask& task) {
  --tasks_out_;
  if (std::holds_alternative<OpenPointTask>(task)) opening_ = false;
}

void Run::Rest(size_t point, std::shared_ptr<BlockSession> session) {
  if (OpenPoint* open = FindOpen(point)) open->resting.push_back(std::move(session));
}

void Run::PointOpened(size_t point, std::unique_ptr<OpenPoint> open) {
  if (stopped_) open->stop.request_stop();
  open_.emplace(point, std::move(open));
}

OpenPoint* Run::FindOpen(size_t point) {
  const auto open = open_.find(point);
  return open == open_.end() ? nullptr : open->second.get();
}

void Run::PointClosed(size_t point) { open_.erase(point); }

void Run::Stop(absl::Status reason) {
  if (std::exchange(stopped_, true)) return;
  outcome_ = std::move(reason);
  stop_opening_.request_stop();
  for (const auto& [index, point] : open_) point->stop.request_stop();
}

void Run::NoteShortfall(Shortfall shortfall) {
  if (shortfall_ && shortfall_->point < shortfall.point) return;
  shortfall_ = std::move(shortfall);
}

bool Run::over() const {
  if (tasks_out_ > 0) return false;
  return stopped_ || (open_.empty() && next_point_ == request_.finished.size());
}

}  // namespace ballpiston::server
