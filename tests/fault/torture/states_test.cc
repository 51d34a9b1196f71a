// Clients share their jobs, and the server is killed under them. What one of them has seen of a
// job, no later call takes back, whoever makes it: Create, Get, List, Watch, Cancel and Pin.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "client/library/job_watch.h"
#include "core/geometry/paper.h"
#include "tests/fault/torture/calls.h"
#include "tests/fault/torture/connected_server.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/sizes.h"

namespace ballpiston::torture {
namespace {

using v1::EnsembleJob;

constexpr int kClients = 8;
constexpr size_t kMostJobs = 50;  // on one page, so that clients look at each other's jobs
constexpr std::chrono::milliseconds kTimeOfWatch(200);

// A result of some 10 kB after a few milliseconds.
v1::EnsembleSpec SmallQuestion() {
  v1::EnsembleSpec spec;
  spec.set_experiment(v1::EnsembleSpec::FIRST_HIT);
  spec.set_model(v1::EnsembleSpec::BILLIARD);
  spec.mutable_grid()->add_rho(kPaperRho);
  spec.mutable_grid()->add_delta(0.2);
  spec.mutable_grid()->add_epsilon(0.1);
  spec.mutable_grid()->add_exponent(1);
  spec.mutable_target()->set_samples(4000);
  return spec;
}

// QUEUED, RUNNING, CANCELLING, an end, deleted.
int RankOf(EnsembleJob::State state) {
  return client::HasEnded(state) ? 3 : static_cast<int>(state) - EnsembleJob::QUEUED;
}
constexpr int kDeleted = 4;

// The last state that was seen of each job, by any client. Thread-safe.
class History {
 public:
  struct Seen {
    int rank = 0;
    EnsembleJob::State end = EnsembleJob::STATE_UNSPECIFIED;
    std::string what;  // the state and the call that returned it
  };

  explicit History(Findings& findings) : findings_(findings) {}

  Seen Of(const std::string& job) const {
    const std::lock_guard lock(mutex_);
    const auto found = jobs_.find(job);
    return found == jobs_.end() ? Seen() : found->second;
  }

  // `before`: what was seen before the call began.
  void Learn(const Seen& before, const EnsembleJob& job, const char* call) {
    const Seen now{RankOf(job.state()),
                   client::HasEnded(job.state()) ? job.state() : EnsembleJob::STATE_UNSPECIFIED,
                   absl::StrCat(EnsembleJob::State_Name(job.state()), " by ", call)};
    findings_.Count("states seen");
    const bool other_end = before.rank == 3 && now.rank == 3 && before.end != now.end;
    if (now.rank < before.rank || other_end) {
      findings_.Wrong(absl::StrCat(job.name(), ": ", now.what, " after ", before.what));
    }
    const std::lock_guard lock(mutex_);
    Seen& last = jobs_[job.name()];
    if (now.rank > last.rank || last.what.empty()) last = now;
  }

  void Delete(const std::string& job) {
    const std::lock_guard lock(mutex_);
    jobs_[job] = {.rank = kDeleted, .what = "its deletion"};
  }

  // The jobs that are not deleted.
  std::vector<std::string> Names() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> names;
    for (const auto& [name, seen] : jobs_) {
      if (seen.rank < kDeleted) names.push_back(name);
    }
    return names;
  }

 private:
  Findings& findings_;
  mutable std::mutex mutex_;
  std::map<std::string, Seen> jobs_;
};

class Client {
 public:
  Client(std::shared_ptr<grpc::Channel> channel, uint64_t seed, History& history,
         Findings& findings)
      : stub_(v1::EnsembleService::NewStub(channel)),
        random_(seed),
        history_(history),
        findings_(findings) {}

  void CallUntil(const std::atomic<bool>& enough) {
    while (!enough) {
      const std::vector<std::string> names = history_.Names();
      if (names.size() < kMostJobs && random_() % 2 == 0) Create();
      if (!names.empty())
        (this->*kCalls[random_() % kCalls.size()])(names[random_() % names.size()]);
    }
  }

 private:
  using Call = void (Client::*)(const std::string& name);

  void Create() {
    v1::CreateEnsembleJobRequest request;
    *request.mutable_spec() = SmallQuestion();
    request.mutable_spec()->set_seed(random_());
    Learn({}, Ask(*stub_, &Stub::CreateEnsembleJob, request), "Create");
  }

  void Get(const std::string& name) {
    v1::GetEnsembleJobRequest request;
    request.set_name(name);
    const History::Seen before = history_.Of(name);
    Learn(before, Ask(*stub_, &Stub::GetEnsembleJob, request), "Get");
  }

  void List(const std::string&) {
    v1::ListEnsembleJobsRequest request;
    request.set_view(random_() % 2 == 0 ? v1::ListEnsembleJobsRequest::BASIC
                                        : v1::ListEnsembleJobsRequest::FULL);
    std::map<std::string, History::Seen> before;
    for (const std::string& name : history_.Names()) before[name] = history_.Of(name);
    const auto page = Ask(*stub_, &Stub::ListEnsembleJobs, request);
    if (!page.ok()) return Check(page.status(), "List");
    for (const EnsembleJob& job : page->jobs()) history_.Learn(before[job.name()], job, "List");
    for (const EnsembleJob& job : page->jobs()) Get(job.name());
  }

  void Watch(const std::string& name) {
    v1::WatchEnsembleJobRequest request;
    request.set_name(name);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kTimeOfWatch);
    History::Seen before = history_.Of(name);
    const auto reader = stub_->WatchEnsembleJob(&context, request);
    v1::WatchEnsembleJobResponse message;
    while (reader->Read(&message)) {
      if (!message.has_job()) continue;
      history_.Learn(before, message.job(), "Watch");
      before = {RankOf(message.job().state()), message.job().state(), "an earlier message"};
    }
    Check(client::FromGrpc(reader->Finish()), "Watch");
  }

  void Cancel(const std::string& name) {
    v1::CancelEnsembleJobRequest request;
    request.set_name(name);
    const History::Seen before = history_.Of(name);
    Learn(before, Ask(*stub_, &Stub::CancelEnsembleJob, request), "Cancel");
  }

  void Update(const std::string& name) {
    v1::UpdateEnsembleJobRequest request;
    request.mutable_job()->set_name(name);
    request.mutable_job()->set_pinned(random_() % 2 == 0);
    request.mutable_update_mask()->add_paths("pinned");
    const History::Seen before = history_.Of(name);
    Learn(before, Ask(*stub_, &Stub::UpdateEnsembleJob, request), "Update");
  }

  void Delete(const std::string& name) {
    if (history_.Of(name).rank < 3) return;
    v1::DeleteEnsembleJobRequest request;
    request.set_name(name);
    const absl::Status deleted = Ask(*stub_, &Stub::DeleteEnsembleJob, request).status();
    // Not found: another client, or a call that was not answered, has deleted it.
    if (deleted.ok() || absl::IsNotFound(deleted)) history_.Delete(name);
    Check(deleted, "Delete");
  }

  // Get and List twice as often as the others.
  static constexpr std::array<Call, 8> kCalls = {&Client::Get,   &Client::Get,    &Client::List,
                                                 &Client::List,  &Client::Update, &Client::Cancel,
                                                 &Client::Watch, &Client::Delete};

  void Learn(const History::Seen& before, const absl::StatusOr<EnsembleJob>& job,
             const char* call) {
    if (job.ok()) return history_.Learn(before, *job, call);
    Check(job.status(), call);
  }

  // Another client may have deleted the job, or it has ended.
  void Check(const absl::Status& status, const char* call) {
    const bool expected = status.ok() || WasNotAnswered(status) || absl::IsNotFound(status) ||
                          absl::IsFailedPrecondition(status);
    if (!expected) findings_.Wrong(absl::StrCat(call, ": ", status.ToString()));
  }

  std::unique_ptr<Stub> stub_;
  std::mt19937_64 random_;
  History& history_;
  Findings& findings_;
};

// In the short form the server lives until the clients have seen this many states.
constexpr int kStatesOfALife = 6000;

TEST(States, OfAJobNeverGoBackWhoeverLooks) {
  Findings findings("states that clients see");
  History history(findings);
  ConnectedServer server;
  std::vector<Client> clients;
  for (int i = 0; i < kClients; ++i) {
    clients.emplace_back(server.Connect(), static_cast<uint64_t>(i), history, findings);
  }
  server.Start();
  std::atomic<bool> enough = false;
  std::vector<std::jthread> threads;
  for (Client& client : clients) threads.emplace_back([&] { client.CallUntil(enough); });
  const absl::Cleanup end_calls = [&] { enough = true; };
  for (int life = 1; life <= 3; ++life) {
    const int64_t states = life * int64_t{Size(kStatesOfALife, 60'000)};
    AwaitThat([&] { return findings.count("states seen") >= states; });
    if (life == 3) break;
    server.KillHard();
    server.Start();
    findings.Count("kills");
  }
  enough = true;
  threads.clear();  // waits for them
  EXPECT_EQ(findings.Report(), "");
}

}  // namespace
}  // namespace ballpiston::torture
