#include "tests/fault/torture/visitor.h"

#include "client/library/error_text.h"
#include "client/library/job_watch.h"
#include "client/library/request_id.h"
#include "tests/fault/torture/calls.h"
#include "tests/fault/torture/preamble.h"

namespace ballpiston::torture {
namespace {

using client::HasEnded;

// More active jobs would only wait for the two cores.
constexpr size_t kMostActive = 3;
// Enough jobs for the lists, few enough to check all at the end.
size_t MostKept() { return static_cast<size_t>(Size(6, 40)); }

}  // namespace

Visitor::Visitor(std::shared_ptr<grpc::Channel> channel, const Exam& exam, uint64_t seed,
                 Findings& findings)
    : stub_(v1::EnsembleService::NewStub(channel)),
      exam_(exam),
      findings_(findings),
      random_(seed) {}

template <typename Call>
auto Visitor::UntilAnswered(Call call, bool& repeated) {
  repeated = false;
  while (true) {
    auto result = call();
    if (!WasNotAnswered(StatusOf(result))) return result;
    findings_.Count("calls without an answer, repeated");
    if (absl::IsCancelled(StatusOf(result))) findings_.Count("of which CANCELLED by gRPC");
    repeated = true;
    std::this_thread::sleep_for(kPauseBeforeRepeating);
  }
}

template <typename Call>
auto Visitor::UntilAnswered(Call call) {
  bool repeated = false;
  return UntilAnswered(std::move(call), repeated);
}

void Visitor::VisitUntil(const std::atomic<bool>& enough) {
  while (!enough) DoSomething();
}

void Visitor::DoSomething() {
  if (jobs_.size() < MostKept() && CountActive() < kMostActive && Chance(0.5)) return Create();
  if (jobs_.empty()) return;
  const size_t index = Pick(jobs_.size());
  OwnJob& job = jobs_[index];
  const bool ended = HasEnded(job.end);
  if (Chance(0.1)) return AskAgain(job);
  if (Chance(0.05)) return List();
  if (!ended) return Chance(0.2) ? Cancel(job) : Chance(0.5) ? Get(job) : Watch(job);
  if (Chance(jobs_.size() < MostKept() ? 0.2 : 0.5)) return Delete(index);
  return Chance(0.5) ? Fetch(job) : Get(job);
}

void Visitor::Create() {
  OwnJob job;
  job.question = Pick(exam_.questions.size());
  job.request_id = client::NewRequestId();
  v1::CreateEnsembleJobRequest request;
  *request.mutable_spec() = exam_.questions[job.question];
  request.set_request_id(job.request_id);
  request.set_fresh(true);  // not the answer of another client's job
  const auto made = UntilAnswered([&] { return Ask(*stub_, &Stub::CreateEnsembleJob, request); });
  if (!made.ok()) return Wrong(job, absl::StrCat("Create: ", made.status().ToString()));
  findings_.Count("jobs acknowledged");
  job.name = made->name();
  Learn(job, *made, "Create");
  jobs_.push_back(std::move(job));
}

void Visitor::AskAgain(const OwnJob& job) {
  v1::CreateEnsembleJobRequest request;
  *request.mutable_spec() = exam_.questions[job.question];
  request.set_request_id(job.request_id);
  request.set_fresh(true);
  const auto again = UntilAnswered([&] { return Ask(*stub_, &Stub::CreateEnsembleJob, request); });
  if (!again.ok()) return Wrong(job, absl::StrCat("asked again: ", again.status().ToString()));
  findings_.Count("request ids asked again");
  if (again->name() != job.name) Wrong(job, absl::StrCat("asked again, made ", again->name()));
}

void Visitor::Get(OwnJob& job) {
  v1::GetEnsembleJobRequest request;
  request.set_name(job.name);
  const auto seen = UntilAnswered([&] { return Ask(*stub_, &Stub::GetEnsembleJob, request); });
  if (!seen.ok()) return Wrong(job, absl::StrCat("Get: ", seen.status().ToString()));
  Learn(job, *seen, "Get");
}

void Visitor::Watch(OwnJob& job) {
  findings_.Count("watches");
  v1::WatchEnsembleJobRequest request;
  request.set_name(job.name);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(500));
  const auto reader = stub_->WatchEnsembleJob(&context, request);
  v1::WatchEnsembleJobResponse message;
  while (reader->Read(&message)) {
    if (message.has_job()) Learn(job, message.job(), "Watch");
  }
  const absl::Status end = client::FromGrpc(reader->Finish());
  if (end.ok() && !HasEnded(job.end)) Wrong(job, "a watch was OK before the end");
  if (!end.ok() && !WasNotAnswered(end)) Wrong(job, absl::StrCat("Watch: ", end.ToString()));
}

void Visitor::Cancel(OwnJob& job) {
  v1::CancelEnsembleJobRequest request;
  request.set_name(job.name);
  request.set_request_id(client::NewRequestId());
  const auto seen = UntilAnswered([&] { return Ask(*stub_, &Stub::CancelEnsembleJob, request); });
  if (seen.ok()) {
    findings_.Count("cancellations acknowledged");
    job.cancelled = true;
    return Learn(job, *seen, "Cancel");
  }
  if (client::ErrorReason(seen.status()) == "JOB_ALREADY_ENDED") return Get(job);
  Wrong(job, absl::StrCat("Cancel: ", seen.status().ToString()));
}

void Visitor::Delete(size_t index) {
  v1::DeleteEnsembleJobRequest request;
  request.set_name(jobs_[index].name);
  bool repeated = false;
  const absl::Status deleted = UntilAnswered(
      [&] { return Ask(*stub_, &Stub::DeleteEnsembleJob, request).status(); }, repeated);
  const bool before = repeated && absl::IsNotFound(deleted);
  if (!deleted.ok() && !before) {
    return Wrong(jobs_[index], absl::StrCat("Delete: ", deleted.ToString()));
  }
  findings_.Count("deletions acknowledged");
  jobs_.erase(jobs_.begin() + static_cast<std::ptrdiff_t>(index));
}

void Visitor::List() {
  v1::ListEnsembleJobsRequest request;
  const auto page = UntilAnswered([&] { return Ask(*stub_, &Stub::ListEnsembleJobs, request); });
  if (!page.ok()) return findings_.Wrong(absl::StrCat("List: ", page.status().ToString()));
  findings_.Count("lists");
  std::map<std::string, const v1::EnsembleJob*> listed;
  for (const v1::EnsembleJob& job : page->jobs()) listed[job.name()] = &job;
  for (OwnJob& job : jobs_) {
    if (const auto found = listed.find(job.name); found != listed.end())
      Learn(job, *found->second, "List");
  }
}

void Visitor::Fetch(const OwnJob& job) {
  std::vector<v1::PointResult> points;
  v1::ListResultsRequest request;
  request.set_parent(job.name);
  do {
    const auto page = UntilAnswered([&] { return Ask(*stub_, &Stub::ListResults, request); });
    if (!page.ok()) return Wrong(job, absl::StrCat("ListResults: ", page.status().ToString()));
    points.insert(points.end(), page->results().begin(), page->results().end());
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  const Answer& expected = exam_.answers[job.question];
  for (const auto& [index, bytes] : AnswerOf(points)) {
    if (expected.at(index) == bytes) continue;
    return Wrong(job, absl::StrCat("point ", index, " has other bytes than undisturbed"));
  }
  findings_.Count("results compared byte by byte", static_cast<int64_t>(points.size()));
  if (job.end == v1::EnsembleJob::SUCCEEDED && points.size() != expected.size()) {
    Wrong(job, absl::StrCat(points.size(), " points of ", expected.size()));
  }
}

void Visitor::Learn(OwnJob& job, const v1::EnsembleJob& seen, const char* from) {
  if (seen.name() != job.name) Wrong(job, absl::StrCat("is answered as ", seen.name()));
  if (HasEnded(job.end) && seen.state() != job.end) {
    Wrong(job, absl::StrCat("ended as ", v1::EnsembleJob::State_Name(job.end), " by ", job.end_from,
                            ", now ", v1::EnsembleJob::State_Name(seen.state()), " by ", from));
  }
  const bool given_up =
      seen.state() == v1::EnsembleJob::CANCELLED || seen.state() == v1::EnsembleJob::CANCELLING;
  if (job.cancelled && !given_up) {
    Wrong(job, absl::StrCat("was cancelled, is ", v1::EnsembleJob::State_Name(seen.state())));
  }
  if (seen.state() == v1::EnsembleJob::FAILED) Wrong(job, seen.error().ShortDebugString());
  if (!HasEnded(seen.state())) return;
  if (!HasEnded(job.end)) CheckSamples(job, seen);
  job.end = seen.state();
  job.end_from = from;
}

// The job's number of samples must be the sum over its points.
void Visitor::CheckSamples(const OwnJob& job, const v1::EnsembleJob& seen) {
  if (seen.state() != v1::EnsembleJob::SUCCEEDED) return;
  findings_.Count("jobs that succeeded");
  double samples = 0;
  for (const auto& [index, bytes] : exam_.answers[job.question]) {
    v1::PointResult point;
    point.ParseFromString(bytes);
    samples += point.samples();
  }
  if (seen.progress().samples() == samples) return;
  Wrong(job, absl::StrCat("counts ", seen.progress().samples(), " samples of ", samples));
}

void Visitor::CheckAll() {
  for (OwnJob& job : jobs_) {
    client::WatchOptions options;
    options.give_up_after = absl::FromChrono(kPatience);
    const auto ended = client::WatchJob(*stub_, job.name, {}, options);
    if (!ended.ok()) {
      Wrong(job, absl::StrCat("at the end: ", ended.status().ToString()));
      continue;
    }
    Learn(job, *ended, "the library's watch");
    Get(job);
    Fetch(job);
    AskAgain(job);
  }
}

std::set<std::string> Visitor::names() const {
  std::set<std::string> names;
  for (const OwnJob& job : jobs_) names.insert(job.name);
  return names;
}

bool Visitor::Chance(double probability) {
  return std::bernoulli_distribution(probability)(random_);
}

size_t Visitor::Pick(size_t count) {
  return std::uniform_int_distribution<size_t>(0, count - 1)(random_);
}

size_t Visitor::CountActive() const {
  size_t active = 0;
  for (const OwnJob& job : jobs_) active += HasEnded(job.end) ? 0 : 1;
  return active;
}

void Visitor::Wrong(const OwnJob& job, const std::string& what) {
  findings_.Wrong(absl::StrCat(job.name.empty() ? job.request_id : job.name, " (question ",
                               job.question, "): ", what));
}

}  // namespace ballpiston::torture
