// One client among several, at random: creates jobs, looks them up, watches, cancels, deletes, and
// fetches their results, while the server is killed under it. It repeats each call until it has an
// answer, remembers every answer, and reports when the server breaks one of these rules:
//   1. a request id means one job, also after retries;
//   2. a job that was acknowledged exists until its deletion is requested;
//   3. a cancellation that was acknowledged ends in CANCELLED;
//   4. an end that was seen stays that end;
//   5. a job that succeeded has the undisturbed answer, byte by byte, and its samples once.
// tests/simulation checks more: lists, the messages of watches, and states in the order of calls.
#pragma once

#include <grpcpp/grpcpp.h>

#include "client/library/client.h"
#include "client/library/error_text.h"
#include "client/library/request_id.h"
#include "tests/fault/torture/questions.h"
#include "tests/support/dice.h"

namespace ballpiston::torture {

struct Exam {
  std::vector<v1::EnsembleSpec> questions;
  std::vector<Answer> answers;
};

// Not thread-safe.
class Visitor {
 public:
  Visitor(std::shared_ptr<grpc::Channel> channel, const Exam& exam, uint64_t seed,
          Findings& findings)
      : channel_(std::move(channel)), exam_(exam), findings_(findings), dice_(seed) {}

  void VisitUntil(const std::atomic<bool>& enough) {
    while (!enough) DoSomething();
  }

  // For a server that is not killed any more: waits for the end of every job and checks it.
  void CheckAll() {
    for (OwnJob& job : jobs_) {
      const auto ended =
          client_.Watch(job.name, {}, {.give_up_after = absl::FromChrono(kPatience)});
      if (!IsAnswered(job, "the last watch", ended)) continue;
      Learn(job, *ended);
      Get(job);
      Fetch(job);
      AskAgain(job);
    }
  }

  std::set<std::string> names() const {  // of the jobs that must exist
    std::set<std::string> names;
    for (const OwnJob& job : jobs_) names.insert(job.name);
    return names;
  }

 private:
  struct OwnJob {
    size_t question = 0;
    std::string request_id;
    std::string name;
    bool cancelled = false;  // and acknowledged
    v1::EnsembleJob::State end = v1::EnsembleJob::STATE_UNSPECIFIED;
  };

  // More active jobs would only wait for the two cores.
  static constexpr int kMostActive = 3;
  // Few enough to check all at the end.
  static size_t MostKept() { return static_cast<size_t>(Size(6, 40)); }

  // A call that reaches a server just as it stops is CANCELLED by gRPC, without a reason.
  static bool WasNotAnswered(const absl::Status& status) {
    const bool dropped = absl::IsCancelled(status) && client::ErrorReason(status).empty();
    return absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status) || dropped;
  }

  // Calls as soon as the server is connected, and repeats the call until the server answers.
  // `repeated`: whether it was necessary.
  template <typename Call>
  auto UntilAnswered(Call call, bool* repeated = nullptr) {
    while (true) {
      channel_->WaitForConnected(std::chrono::system_clock::now() + kPatience);
      auto result = call();
      if (!WasNotAnswered(StatusOf(result))) return result;
      findings_.Count("calls without an answer, repeated");
      if (absl::IsCancelled(StatusOf(result))) findings_.Count("of which CANCELLED by gRPC");
      if (repeated != nullptr) *repeated = true;
    }
  }

  void DoSomething() {
    const auto active = std::count_if(jobs_.begin(), jobs_.end(),
                                      [](const OwnJob& job) { return !client::HasEnded(job.end); });
    if (jobs_.size() < MostKept() && active < kMostActive && dice_.Chance(0.5)) return Create();
    if (jobs_.empty()) return;
    const size_t index = dice_.Below(jobs_.size());
    OwnJob& job = jobs_[index];
    if (dice_.Chance(0.1)) return AskAgain(job);
    if (!client::HasEnded(job.end)) {
      return dice_.Chance(0.2) ? Cancel(job) : dice_.Chance(0.5) ? Get(job) : Watch(job);
    }
    if (dice_.Chance(jobs_.size() < MostKept() ? 0.2 : 0.5)) return Delete(index);
    return dice_.Chance(0.5) ? Fetch(job) : Get(job);
  }

  // Whether the answer is OK. Reports any other answer as a broken promise.
  template <typename Result>
  bool IsAnswered(const OwnJob& job, const char* call, const Result& answer) {
    const absl::Status status = StatusOf(answer);
    if (!status.ok()) Wrong(job, absl::StrCat(call, ": ", status.ToString()));
    return status.ok();
  }

  // The job of this request id, new or made before. `fresh`: not the answer of another client's
  // job.
  absl::StatusOr<v1::EnsembleJob> Ask(const OwnJob& job) {
    v1::CreateEnsembleJobRequest request;
    *request.mutable_spec() = exam_.questions[job.question];
    request.set_request_id(job.request_id);
    request.set_fresh(true);
    return UntilAnswered([&] { return client_.Create(request); });
  }

  void Create() {
    OwnJob job;
    job.question = dice_.Below(exam_.questions.size());
    job.request_id = client::NewRequestId();
    const auto made = Ask(job);
    if (!IsAnswered(job, "Create", made)) return;
    findings_.Count("jobs acknowledged");
    job.name = made->name();
    Learn(job, *made);
    jobs_.push_back(std::move(job));
  }

  void AskAgain(const OwnJob& job) {
    const auto again = Ask(job);
    if (!IsAnswered(job, "asked again", again)) return;
    findings_.Count("request ids asked again");
    if (again->name() != job.name) Wrong(job, absl::StrCat("asked again, made ", again->name()));
  }

  void Get(OwnJob& job) {
    const auto seen = UntilAnswered([&] { return client_.Get(job.name); });
    if (IsAnswered(job, "Get", seen)) Learn(job, *seen);
  }

  // Until the end of the job or of the connection.
  void Watch(OwnJob& job) {
    findings_.Count("watches");
    std::stop_source stop;
    client::WatchCallbacks callbacks;
    callbacks.on_job = [&](const v1::EnsembleJob& seen) { Learn(job, seen); };
    callbacks.on_disconnect = [&](const absl::Status&, absl::Duration) { stop.request_stop(); };
    const auto end = client_.Watch(job.name, callbacks, {}, stop.get_token());
    if (end.ok() && !client::HasEnded(job.end)) Wrong(job, "a watch was OK before the end");
    if (!WasNotAnswered(end.status())) IsAnswered(job, "Watch", end);
  }

  void Cancel(OwnJob& job) {
    const auto seen = UntilAnswered([&] { return client_.Cancel(job.name); });
    if (client::ErrorReason(seen.status()) == "JOB_ALREADY_ENDED") return Get(job);
    if (!IsAnswered(job, "Cancel", seen)) return;
    findings_.Count("cancellations acknowledged");
    job.cancelled = true;
    Learn(job, *seen);
  }

  void Delete(size_t index) {
    bool repeated = false;
    const absl::Status deleted =
        UntilAnswered([&] { return client_.Delete(jobs_[index].name); }, &repeated);
    const bool was_deleted_before = repeated && absl::IsNotFound(deleted);
    if (!was_deleted_before && !IsAnswered(jobs_[index], "Delete", deleted)) return;
    findings_.Count("deletions acknowledged");
    jobs_.erase(jobs_.begin() + static_cast<std::ptrdiff_t>(index));
  }

  void Fetch(const OwnJob& job) {
    const auto points = UntilAnswered([&] { return client_.Results(job.name); });
    if (!IsAnswered(job, "Results", points)) return;
    const Answer& expected = exam_.answers[job.question];
    for (const auto& [index, bytes] : AnswerOf(*points)) {
      if (expected.at(index) == bytes) continue;
      return Wrong(job, absl::StrCat("point ", index, " has other bytes than undisturbed"));
    }
    findings_.Count("results compared byte by byte", std::ssize(*points));
    if (job.end == v1::EnsembleJob::SUCCEEDED && points->size() != expected.size()) {
      Wrong(job, absl::StrCat(points->size(), " points of ", expected.size()));
    }
  }

  void Learn(OwnJob& job, const v1::EnsembleJob& seen) {
    if (seen.name() != job.name) Wrong(job, absl::StrCat("is answered as ", seen.name()));
    if (client::HasEnded(job.end) && seen.state() != job.end) {
      Wrong(job, absl::StrCat("ended as ", v1::EnsembleJob::State_Name(job.end), ", now ",
                              v1::EnsembleJob::State_Name(seen.state())));
    }
    const bool given_up =
        seen.state() == v1::EnsembleJob::CANCELLED || seen.state() == v1::EnsembleJob::CANCELLING;
    if (job.cancelled && !given_up) {
      Wrong(job, absl::StrCat("was cancelled, is ", v1::EnsembleJob::State_Name(seen.state())));
    }
    if (seen.state() == v1::EnsembleJob::FAILED) Wrong(job, seen.error().ShortDebugString());
    if (!client::HasEnded(seen.state())) return;
    if (!client::HasEnded(job.end) && seen.state() == v1::EnsembleJob::SUCCEEDED) {
      findings_.Count("jobs that succeeded");
      double samples = 0;
      for (const auto& [index, bytes] : exam_.answers[job.question]) {
        v1::PointResult point;
        point.ParseFromString(bytes);
        samples += point.samples();
      }
      if (seen.progress().samples() != samples) {
        Wrong(job, absl::StrCat("counts ", seen.progress().samples(), " samples of ", samples));
      }
    }
    job.end = seen.state();
  }

  void Wrong(const OwnJob& job, const std::string& what) {
    findings_.Wrong(absl::StrCat(job.name.empty() ? job.request_id : job.name, " (question ",
                                 job.question, "): ", what));
  }

  const std::shared_ptr<grpc::Channel> channel_;
  const client::Client client_{channel_, absl::Seconds(20)};
  const Exam& exam_;
  Findings& findings_;
  Dice dice_;
  std::vector<OwnJob> jobs_;
};

}  // namespace ballpiston::torture
