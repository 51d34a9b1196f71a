// One client among several, at random: creates jobs, looks them up, watches, cancels, deletes, and
// fetches their results, while the server is killed under it. It repeats each call until it has an
// answer, remembers every answer, and reports when the server breaks one of these rules:
//   1. a request id means one job, also after retries;
//   2. a job that was acknowledged exists until its deletion is requested;
//   3. a cancellation that was acknowledged ends in CANCELLED;
//   4. an end that was seen stays that end;
//   5. a job that succeeded has the undisturbed answer, byte by byte, and its samples once.
#pragma once

#include <grpcpp/grpcpp.h>

#include "client/library/client.h"
#include "client/library/error_text.h"
#include "client/library/request_id.h"
#include "tests/fault/torture/preamble.h"
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
      if (!ended.ok()) {
        Wrong(job, absl::StrCat("at the end: ", ended.status().ToString()));
        continue;
      }
      Learn(job, *ended, "the last watch");
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
    const char* end_from = "";  // the call that returned it
  };

  // More active jobs would only wait for the two cores.
  static constexpr int kMostActive = 3;
  // Enough jobs for the lists, few enough to check all at the end.
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
    if (dice_.Chance(0.05)) return List();
    if (!client::HasEnded(job.end)) {
      return dice_.Chance(0.2) ? Cancel(job) : dice_.Chance(0.5) ? Get(job) : Watch(job);
    }
    if (dice_.Chance(jobs_.size() < MostKept() ? 0.2 : 0.5)) return Delete(index);
    return dice_.Chance(0.5) ? Fetch(job) : Get(job);
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
    if (!made.ok()) return Wrong(job, absl::StrCat("Create: ", made.status().ToString()));
    findings_.Count("jobs acknowledged");
    job.name = made->name();
    Learn(job, *made, "Create");
    jobs_.push_back(std::move(job));
  }

  void AskAgain(const OwnJob& job) {
    const auto again = Ask(job);
    if (!again.ok()) return Wrong(job, absl::StrCat("asked again: ", again.status().ToString()));
    findings_.Count("request ids asked again");
    if (again->name() != job.name) Wrong(job, absl::StrCat("asked again, made ", again->name()));
  }

  void Get(OwnJob& job) {
    const auto seen = UntilAnswered([&] { return client_.Get(job.name); });
    if (!seen.ok()) return Wrong(job, absl::StrCat("Get: ", seen.status().ToString()));
    Learn(job, *seen, "Get");
  }

  // Until the end of the job or of the connection.
  void Watch(OwnJob& job) {
    findings_.Count("watches");
    std::stop_source stop;
    client::WatchCallbacks callbacks;
    callbacks.on_job = [&](const v1::EnsembleJob& seen) { Learn(job, seen, "Watch"); };
    callbacks.on_disconnect = [&](const absl::Status&, absl::Duration) { stop.request_stop(); };
    const auto end = client_.Watch(job.name, callbacks, {}, stop.get_token());
    if (end.ok() && !client::HasEnded(job.end)) Wrong(job, "a watch was OK before the end");
    if (!end.ok() && !WasNotAnswered(end.status())) {
      Wrong(job, absl::StrCat("Watch: ", end.status().ToString()));
    }
  }

  void Cancel(OwnJob& job) {
    const auto seen = UntilAnswered([&] { return client_.Cancel(job.name); });
    if (seen.ok()) {
      findings_.Count("cancellations acknowledged");
      job.cancelled = true;
      return Learn(job, *seen, "Cancel");
    }
    if (client::ErrorReason(seen.status()) == "JOB_ALREADY_ENDED") return Get(job);
    Wrong(job, absl::StrCat("Cancel: ", seen.status().ToString()));
  }

  void Delete(size_t index) {
    bool repeated = false;
    const absl::Status deleted =
        UntilAnswered([&] { return client_.Delete(jobs_[index].name); }, &repeated);
    if (!deleted.ok() && !(repeated && absl::IsNotFound(deleted))) {
      return Wrong(jobs_[index], absl::StrCat("Delete: ", deleted.ToString()));
    }
    findings_.Count("deletions acknowledged");
    jobs_.erase(jobs_.begin() + static_cast<std::ptrdiff_t>(index));
  }

  void List() {
    const auto listed = UntilAnswered([&] { return client_.List(); });
    if (!listed.ok()) return findings_.Wrong(absl::StrCat("List: ", listed.status().ToString()));
    findings_.Count("lists");
    for (OwnJob& job : jobs_) {
      const auto found =
          std::find_if(listed->begin(), listed->end(),
                       [&](const v1::EnsembleJob& seen) { return seen.name() == job.name; });
      if (found != listed->end()) Learn(job, *found, "List");
    }
  }

  void Fetch(const OwnJob& job) {
    const auto points = UntilAnswered([&] { return client_.Results(job.name); });
    if (!points.ok()) return Wrong(job, absl::StrCat("Results: ", points.status().ToString()));
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

  // `from`: the call that was answered.
  void Learn(OwnJob& job, const v1::EnsembleJob& seen, const char* from) {
    if (seen.name() != job.name) Wrong(job, absl::StrCat("is answered as ", seen.name()));
    if (client::HasEnded(job.end) && seen.state() != job.end) {
      Wrong(job,
            absl::StrCat("ended as ", v1::EnsembleJob::State_Name(job.end), " by ", job.end_from,
                         ", now ", v1::EnsembleJob::State_Name(seen.state()), " by ", from));
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
    job.end_from = from;
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
