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
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/questions.h"
#include "tests/support/dice.h"
#include "tests/support/preamble.h"

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
  void CheckAll();
  std::set<std::string> names() const;  // of the jobs that must exist

 private:
  struct OwnJob {
    size_t question = 0;
    std::string request_id;
    std::string name;
    bool cancelled = false;  // and acknowledged
    v1::EnsembleJob::State end = v1::EnsembleJob::STATE_UNSPECIFIED;
    const char* end_from = "";  // the call that returned it
  };

  // Calls as soon as the server is connected, and repeats the call until the server answers.
  // `repeated`: whether it was necessary.
  template <typename Call>
  auto UntilAnswered(Call call, bool* repeated = nullptr);
  // The job of this request id, new or made before.
  absl::StatusOr<v1::EnsembleJob> Ask(const OwnJob& job);

  void DoSomething();
  void Create();
  void AskAgain(const OwnJob& job);
  void Get(OwnJob& job);
  void Watch(OwnJob& job);
  void Cancel(OwnJob& job);
  void Delete(size_t index);
  void List();
  void Fetch(const OwnJob& job);

  // `from`: the call that was answered.
  void Learn(OwnJob& job, const v1::EnsembleJob& seen, const char* from);
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
