#include "tests/fault/torture/watch_chain.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/library/error_text.h"
#include "client/library/job_watch.h"

namespace ballpiston::torture {
namespace {

using v1::EnsembleJob;

const std::string& NameOf(EnsembleJob::State state) { return EnsembleJob::State_Name(state); }

// QUEUED < RUNNING < CANCELLING < the three ends, as the enumeration has them.
bool GoesBack(EnsembleJob::State before, EnsembleJob::State now) {
  if (client::HasEnded(before)) return now != before;
  return now < before;
}

}  // namespace

WatchChain::WatchChain(std::string job, const std::atomic<int>& life, Findings& findings)
    : life_(life), findings_(findings) {
  request_.set_name(std::move(job));
}

bool WatchChain::Attach(v1::EnsembleService::StubInterface& stub, int messages) {
  grpc::ClientContext context;
  const int before = life_;
  const auto reader = stub.WatchEnsembleJob(&context, request_);
  v1::WatchEnsembleJobResponse message;
  int heard = 0;
  while (heard < messages && reader->Read(&message)) {
    // If the server was restarted since, the stream's life of the server is unknown: it counts as a
    // new one.
    if (heard == 0) {
      life_of_stream_ = life_ == before ? before : -1 - before;
      of_ended_job_ = !message.has_job();
      if (of_ended_job_) CheckThatItHasEnded(stub);
    }
    Hear(message);
    ++heard;
  }
  const bool cut = heard == messages;
  if (cut) {
    context.TryCancel();
    findings_.Count("watches cut");
  }
  CheckEnd(client::FromGrpc(reader->Finish()), cut);
  return heard > 0;
}

// A watch may begin with another message than the job's only if the job has ended.
void WatchChain::CheckThatItHasEnded(v1::EnsembleService::StubInterface& stub) {
  v1::GetEnsembleJobRequest request;
  request.set_name(job());
  grpc::ClientContext context;
  v1::EnsembleJob seen;
  if (!stub.GetEnsembleJob(&context, request, &seen).ok()) return;  // the server was killed
  findings_.Count("watches that begin with points of an ended job");
  if (!client::HasEnded(seen.state())) {
    Wrong(absl::StrCat("begins without the job, which is ", NameOf(seen.state())));
  }
}

void WatchChain::Hear(const v1::WatchEnsembleJobResponse& message) {
  findings_.Count("messages");
  if (ended_) Wrong("a message after the terminal state");
  const bool is_last = message.has_job() && client::HasEnded(message.job().state());
  if (of_ended_job_ && !is_last && message.snapshot().finished_points().empty()) {
    Wrong("of an ended job something else than finished points and the end");
  }
  if (message.resume_token().empty()) Wrong("a message without a token");
  request_.set_resume_token(message.resume_token());
  if (message.has_job()) HearJob(message.job());
  if (!message.has_snapshot()) return;
  HearProgress(message.snapshot().progress());
  for (const v1::PointResult& point : message.snapshot().finished_points()) {
    findings_.Count("finished points told");
    if (!finished_.insert(point.index()).second) {
      Wrong(absl::StrCat("point ", point.index(), " told twice"));
    }
  }
}

void WatchChain::HearJob(const EnsembleJob& job) {
  const bool found_queued = state_ == EnsembleJob::RUNNING && job.state() == EnsembleJob::QUEUED &&
                            state_life_ != life_of_stream_;
  if (found_queued) findings_.Count("jobs that ran found queued by a restart");
  if (GoesBack(state_, job.state()) && !found_queued) {
    Wrong(absl::StrCat("from ", NameOf(state_), " back to ", NameOf(job.state())));
  }
  state_ = job.state();
  state_life_ = life_of_stream_;
  HearProgress(job.progress());
  if (client::HasEnded(state_)) ended_ = state_;
}

void WatchChain::HearProgress(const v1::JobProgress& progress) {
  if (told_life_ == life_of_stream_) {
    if (progress.points_done() < progress_.points_done() ||
        progress.samples() < progress_.samples()) {
      Wrong(absl::StrCat("progress from ", progress_.ShortDebugString(), " back to ",
                         progress.ShortDebugString()));
    }
  }
  progress_ = progress;
  told_life_ = life_of_stream_;
}

void WatchChain::CheckEnd(const absl::Status& end, bool cut) {
  if (end.ok() && !ended_) Wrong("OK before the terminal state");
  if (end.ok() || absl::IsUnavailable(end) || (cut && absl::IsCancelled(end))) return;
  // gRPC ends a stream this way if the server is stopping. The client library also treats it as
  // cut.
  const bool dropped = absl::IsCancelled(end) && client::ErrorReason(end).empty();
  if (!dropped) return Wrong(end.ToString());
  findings_.Count("watches that gRPC cut as the server stopped");
}

void WatchChain::CheckFinishedPoints(v1::EnsembleService::StubInterface& stub) {
  std::set<int> stored;
  v1::ListResultsRequest request;
  request.set_parent(job());
  request.set_view(v1::ListResultsRequest::BASIC);
  do {
    grpc::ClientContext context;
    context.set_wait_for_ready(true);
    v1::ListResultsResponse page;
    if (!stub.ListResults(&context, request, &page).ok()) continue;  // the server was killed: retry
    for (const v1::PointResult& point : page.results()) stored.insert(point.index());
    request.set_page_token(page.next_page_token());
    if (page.next_page_token().empty()) break;
  } while (true);
  findings_.Count("chains heard to the end");
  if (stored == finished_) return;
  Wrong(absl::StrCat("told ", finished_.size(), " finished points of ", stored.size()));
}

void WatchChain::Wrong(const std::string& what) {
  findings_.Wrong(absl::StrCat(request_.name(), ": ", what));
}

}  // namespace ballpiston::torture
