// One client among several, at random: creates jobs, repeats its requests, looks jobs up, cancels
// and deletes them, and fetches their results, while the server is killed under it. It repeats each
// call until it has an answer, and reports when the server breaks one of these rules:
//   1. a request id means one job, also after retries;
//   2. a job that was acknowledged exists until its deletion is requested;
//   3. a cancellation that was acknowledged ends in CANCELLED;
//   4. a job that succeeded has the undisturbed answer, byte by byte, and its samples once.
// The simulation (tests/simulation) checks more rules, with more kinds of calls.
#pragma once

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "client/library/client.h"
#include "client/library/error_text.h"
#include "client/library/request_id.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/sizes.h"
#include "tests/support/await.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::torture {

struct Exam {
  std::vector<v1::EnsembleSpec> questions;
  std::vector<Answer> answers;
};

// Not thread-safe.
class Visitor {
 public:
  Visitor(const std::shared_ptr<grpc::Channel>& channel, const Exam& exam, uint64_t seed,
          Findings& findings)
      : channel_(channel),
        client_(channel, absl::FromChrono(kPatience)),
        exam_(exam),
        findings_(findings),
        random_(seed) {}

  void VisitUntil(const std::atomic<bool>& enough) {
    while (!enough) DoSomething();
  }

  // For a server that is not killed any more: waits for the end of every job and checks it.
  void CheckAll() {
    for (OwnJob& job : jobs_) {
      client_.Watch(job.name, {}).status().IgnoreError();
      Get(job);
      if (!job.has_ended) Wrong(job, "does not end");
      AskAgain(job);
    }
  }

  std::set<std::string> names() const {  // of the jobs that must exist
    std::set<std::string> names;
    for (const OwnJob& job : jobs_) names.insert(job.name);
    return names;
  }

 private:
  // More active jobs would only wait for the cores.
  static constexpr std::ptrdiff_t kMostActive = 3;
  static constexpr std::chrono::milliseconds kPauseBeforeRepeating{20};

  struct OwnJob {
    size_t question = 0;
    std::string request_id = {};
    std::string name = {};
    bool is_cancelled = false;  // and acknowledged
    bool has_ended = false;
  };

  // `was_repeated`: whether an earlier attempt had no answer.
  template <typename Call>
  auto UntilAnswered(Call call, bool* was_repeated = nullptr) {
    while (true) {
      auto result = call();
      const absl::Status status = StatusOf(result);
      // A call that reaches a server just as it stops is CANCELLED by gRPC, without a reason.
      const bool is_dropped = absl::IsCancelled(status) && client::ErrorReason(status).empty();
      if (!absl::IsUnavailable(status) && !is_dropped) return result;
      findings_.Count("calls without an answer, repeated");
      if (was_repeated != nullptr) *was_repeated = true;
      std::this_thread::sleep_for(kPauseBeforeRepeating);
      // If nobody waits, gRPC checks only every 5 s whether the channel is connected again.
      channel_->WaitForConnected(std::chrono::system_clock::now() + kPauseBeforeRepeating);
    }
  }

  void DoSomething() {
    const auto active =
        std::ranges::count_if(jobs_, [](const OwnJob& job) { return !job.has_ended; });
    const auto most_kept = static_cast<size_t>(Size(6, 40));
    if (jobs_.empty() || (jobs_.size() < most_kept && active < kMostActive)) return Create();
    const size_t index = random_() % jobs_.size();
    OwnJob& job = jobs_[index];
    switch (random_() % 10) {
      case 0:
        return AskAgain(job);
      case 1:
        return job.has_ended ? Delete(index) : Cancel(job);
      case 2:
        return job.has_ended && jobs_.size() == most_kept ? Delete(index) : Get(job);
      default:
        return Get(job);
    }
  }

  absl::StatusOr<v1::EnsembleJob> Ask(const OwnJob& job) {
    const client::CreateOptions options = {.request_id = job.request_id, .fresh = true};
    return UntilAnswered([&] { return client_.Create(exam_.questions[job.question], options); });
  }

  void Create() {
    OwnJob job = {.question = random_() % exam_.questions.size(),
                  .request_id = client::NewRequestId()};
    const auto made = Ask(job);
    if (!made.ok()) return Wrong(job, absl::StrCat("Create: ", made.status().ToString()));
    findings_.Count("jobs acknowledged");
    job.name = made->name();
    jobs_.push_back(std::move(job));
  }

  void AskAgain(const OwnJob& job) {
    const auto again = Ask(job);
    findings_.Count("request ids asked again");
    if (!again.ok() || again->name() != job.name) Wrong(job, "asked again is another");
  }

  void Get(OwnJob& job) {
    const auto seen = UntilAnswered([&] { return client_.Get(job.name); });
    if (!seen.ok()) return Wrong(job, absl::StrCat("Get: ", seen.status().ToString()));
    const auto state = seen->state();
    const bool is_given_up =
        state == v1::EnsembleJob::CANCELLED || state == v1::EnsembleJob::CANCELLING;
    if (job.is_cancelled && !is_given_up) Wrong(job, "was cancelled and goes on");
    if (state == v1::EnsembleJob::FAILED) Wrong(job, seen->error().ShortDebugString());
    if (state == v1::EnsembleJob::SUCCEEDED && !job.has_ended) CheckResults(job, *seen);
    job.has_ended = client::HasEnded(state);
  }

  void CheckResults(const OwnJob& job, const v1::EnsembleJob& seen) {
    const auto points = UntilAnswered([&] { return client_.Results(job.name); });
    if (!points.ok()) return Wrong(job, absl::StrCat("Results: ", points.status().ToString()));
    if (AnswerOf(*points) != exam_.answers[job.question]) Wrong(job, "has other bytes");
    double samples = 0;
    for (const v1::PointResult& point : *points) samples += point.samples();
    if (seen.progress().samples() != samples) Wrong(job, "counts samples twice or not at all");
    findings_.Count("jobs compared byte by byte");
  }

  void Cancel(OwnJob& job) {
    const std::string id = client::NewRequestId();
    const auto cancelled = UntilAnswered([&] { return client_.Cancel(job.name, id); });
    if (client::ErrorReason(cancelled.status()) == "JOB_ALREADY_ENDED") return Get(job);
    if (!cancelled.ok()) return Wrong(job, absl::StrCat("Cancel: ", cancelled.status().ToString()));
    findings_.Count("cancellations acknowledged");
    job.is_cancelled = true;
  }

  void Delete(size_t index) {
    bool was_repeated = false;
    const absl::Status deleted =
        UntilAnswered([&] { return client_.Delete(jobs_[index].name); }, &was_repeated);
    const bool is_gone = deleted.ok() || (was_repeated && absl::IsNotFound(deleted));
    if (!is_gone) return Wrong(jobs_[index], absl::StrCat("Delete: ", deleted.ToString()));
    findings_.Count("deletions acknowledged");
    jobs_.erase(jobs_.begin() + static_cast<std::ptrdiff_t>(index));
  }

  void Wrong(const OwnJob& job, const std::string& what) {
    findings_.Wrong(absl::StrCat(job.name, " (question ", job.question, "): ", what));
  }

  const std::shared_ptr<grpc::Channel> channel_;
  const client::Client client_;
  const Exam& exam_;
  Findings& findings_;
  std::mt19937_64 random_;
  std::vector<OwnJob> jobs_;
};

}  // namespace ballpiston::torture
