#include "server/api/watch_ensemble_job.h"

#include <exception>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "server/api/request_check.h"
#include "server/convert/errors.h"
#include "server/jobs/job_state.h"

namespace ballpiston::server {
namespace {

constexpr size_t kMaxSnapshotPoints = 100;

}  // namespace

WatchReactor* WatchReactor::Start(ServiceContext& service, absl::StatusOr<Call> call,
                                  const v1::WatchEnsembleJobRequest& request) {
  std::shared_ptr<WatchReactor> reactor(new WatchReactor(service, std::move(call), request));
  reactor->self_ = reactor;
  service.watches.Add(reactor.get());
  reactor->Schedule();
  return reactor.get();
}

WatchReactor::WatchReactor(ServiceContext& service, absl::StatusOr<Call> call,
                           const v1::WatchEnsembleJobRequest& request)
    : service_(service),
      request_(request),
      call_(std::move(call)),
      active_(service.activity.Begin()),
      next_heartbeat_(Clock::now() + service.timing.heartbeat) {}

// ---- reactions: on gRPC's threads ----

void WatchReactor::OnWriteDone(bool ok) {
  {
    std::lock_guard lock(mutex_);
    writing_ = false;
    cut_ = cut_ || !ok;
  }
  Schedule();
}

void WatchReactor::OnCancel() {
  {
    std::lock_guard lock(mutex_);
    cut_ = true;
  }
  Schedule();
}

void WatchReactor::OnDone() {
  service_.watches.Remove(this);
  self_.reset();  // may delete this
}

// ---- when to speak ----

void WatchReactor::Look(Clock::time_point now) {
  {
    std::lock_guard lock(mutex_);
    if (writing_ || ended_) return;
    const bool state_is_new = job_ != nullptr && job_->last_state_change() > told_state_;
    const bool snapshot_is_due =
        job_ != nullptr && now >= next_snapshot_ && job_->last_change() > told_;
    if (!state_is_new && !snapshot_is_due && now < next_heartbeat_ && !service_.draining) return;
  }
  Schedule();
}

void WatchReactor::Schedule() {
  {
    std::lock_guard lock(mutex_);
    if (ended_) return;
    again_ = scheduled_;
    if (std::exchange(scheduled_, true)) return;
  }
  service_.executor.Post([self = shared_from_this()] { self->Advance(); });
}

void WatchReactor::Advance() {
  try {
    TellWhatIsNew();
  } catch (const std::exception& error) {
    End(WithReason(absl::InternalError(error.what()), "INTERNAL"));
  }
  bool once_more = false;
  {
    std::lock_guard lock(mutex_);
    scheduled_ = false;
    once_more = std::exchange(again_, false);
  }
  if (once_more) Schedule();
}

// ---- what to say ----

void WatchReactor::TellWhatIsNew() {
  bool cut = false;
  {
    std::lock_guard lock(mutex_);
    if (writing_ || ended_) return;
    cut = cut_;
  }
  if (cut) return End(absl::CancelledError("the client is gone"));
  if (!call_.ok()) return End(call_.status());
  if (service_.draining) return End(ShuttingDown());
  if (id_.empty()) {
    const absl::Status found = FindJob();
    if (!found.ok()) return End(found);
    if (job_ == nullptr) return WriteLastAndEnd();
  }
  if (!TellJob() && !TellSnapshot()) TellHeartbeat();
}

absl::Status WatchReactor::FindJob() {
  RequestCheck check;
  const std::string id = check.JobId("name", request_.name());
  if (!check.ok()) return check.status();
  absl::StatusOr<std::shared_ptr<Job>> job = service_.book.FindActive(call_->caller, id);
  if (!job.ok()) return job.status();
  if (*job == nullptr) {
    absl::StatusOr<v1::EnsembleJob> ended = service_.book.Get(call_->caller, id);
    if (!ended.ok()) return ended.status();
    *message_.mutable_job() = *std::move(ended);
  }
  std::lock_guard lock(mutex_);
  id_ = id;
  job_ = *std::move(job);
  if (job_ != nullptr) ReadToken(request_.resume_token());
  return absl::OkStatus();
}

bool WatchReactor::TellJob() {
  const uint64_t change = job_->last_state_change();  // before the message: it may be newer
  if (change <= told_state_) return false;
  message_.Clear();
  *message_.mutable_job() = job_->Message();
  {
    std::lock_guard lock(mutex_);
    told_state_ = change;
  }
  if (HasEnded(message_.job().state())) {
    WriteLastAndEnd();
  } else {
    Write();
  }
  return true;
}

bool WatchReactor::TellSnapshot() {
  const uint64_t change = job_->last_change();
  if (change <= told_ || Clock::now() < next_snapshot_) return false;
  message_.Clear();
  v1::StatisticsSnapshot& snapshot = *message_.mutable_snapshot();
  *snapshot.mutable_progress() = job_->Progress();
  for (v1::PointResult& point :
       service_.book.PointsChangedSince(*job_, told_, kMaxSnapshotPoints)) {
    *snapshot.add_points() = std::move(point);
  }
  {
    std::lock_guard lock(mutex_);
    told_ = change;
    next_snapshot_ = Clock::now() + service_.timing.snapshot;
  }
  const std::string progress = snapshot.progress().SerializeAsString();
  const bool same_progress = std::exchange(told_progress_, progress) == progress;
  if (snapshot.points().empty() && same_progress) return false;
  Write();
  return true;
}

bool WatchReactor::TellHeartbeat() {
  if (Clock::now() < next_heartbeat_) return false;
  message_.Clear();
  message_.mutable_heartbeat();
  Write();
  return true;
}

// ---- resume tokens ----

std::string WatchReactor::Token() const {
  std::string token;
  absl::WebSafeBase64Escape(absl::StrCat(service_.instance, ":", id_, ":", told_), &token);
  return token;
}

void WatchReactor::ReadToken(const std::string& token) {
  std::string text;
  uint64_t told = 0;
  const std::string prefix = absl::StrCat(service_.instance, ":", id_, ":");
  if (absl::WebSafeBase64Unescape(token, &text) && text.rfind(prefix, 0) == 0 &&
      absl::SimpleAtoi(text.substr(prefix.size()), &told) && told <= job_->last_change()) {
    told_ = told;
  }
}

// ---- writing ----

void WatchReactor::Write() {
  message_.set_resume_token(Token());
  {
    std::lock_guard lock(mutex_);
    writing_ = true;
    next_heartbeat_ = Clock::now() + service_.timing.heartbeat;
  }
  StartWrite(&message_);
}

void WatchReactor::WriteLastAndEnd() {
  message_.set_resume_token(Token());
  {
    std::lock_guard lock(mutex_);
    ended_ = true;
  }
  StartWriteAndFinish(&message_, grpc::WriteOptions(), grpc::Status::OK);
}

void WatchReactor::End(const absl::Status& status) {
  {
    std::lock_guard lock(mutex_);
    if (std::exchange(ended_, true)) return;
  }
  Finish(GrpcStatus(status));
}

}  // namespace ballpiston::server
