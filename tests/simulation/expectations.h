// The reference model: which answers a call may have, given the earlier calls and their answers.
//
// An answer is compared with what was known when its call began, because calls overlap and a call
// without an answer may or may not have taken effect. A wrong answer throws Violation.
#pragma once

#include "ballpiston/v1/ensemble.pb.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

// A specification of a toy job. The seed determines the rest of it.
struct Question {
  uint64_t seed = 0;
  int points = 1;
  int64_t blocks = 1;
  bool has_tolerance = false;  // then the points end before their last block
  bool has_key = false;        // all its requests have the same request_id
  bool crashes = false;        // the engine crashes in the last block of each point
};
v1::EnsembleSpec SpecOf(const Question& question);

// Every client derives a question from its seed in this way. From kFirstKeyedSeed on it has a key.
inline constexpr uint64_t kFirstKeyedSeed = 1000;
Question QuestionOf(uint64_t seed);

class Violation : public std::runtime_error {
 public:
  // `check` names the promise. `job`: empty if the promise is not about one job.
  Violation(std::string check, std::string job, const std::string& what)
      : std::runtime_error(check + ": " + job + " " + what),
        check_(std::move(check)),
        job_(std::move(job)) {}

  const std::string& check() const { return check_; }
  const std::string& job() const { return job_; }

 private:
  std::string check_, job_;
};

// The facts that answers gave about a job. States are ordered as in v1::EnsembleJob::State.
struct KnownJob {
  Question question;
  v1::EnsembleJob::State state = v1::EnsembleJob::QUEUED;  // the last one that a call returned
  int points_done = 0;                                     // the most that a call returned
  bool has_ended = false;                                  // and a call said so
  // Calls whose effect is possible: not answered yet, without an answer, or acknowledged.
  int cancels_asked = 0, deletions_asked = 0;
  bool is_cancelled = false, is_deleted = false;  // and the server acknowledged it
};

class Expectations {
 public:
  // The ids of all jobs, including deleted jobs.
  std::vector<std::string> Ids() const;
  const std::map<std::string, KnownJob>& all() const { return jobs_; }
  // The facts about the job up to now. If no answer named this id, the KnownJob has no facts.
  KnownJob Known(const std::string& id) const;

  // ---- answers of calls that began when `before` was known ----

  // `key`: of the request; empty if it has none.
  void Created(const std::map<std::string, KnownJob>& before, const std::string& key,
               const Question& question, const v1::EnsembleJob& job);
  void Got(const KnownJob& before, const v1::EnsembleJob& job);
  // The job was not found, or was not in the list.
  void Missed(const std::string& id);
  void AskedToCancel(const std::string& id) { ++jobs_.at(id).cancels_asked; }
  void Cancelled(const std::string& id) { jobs_.at(id).is_cancelled = true; }
  void AskedToDelete(const std::string& id) { ++jobs_.at(id).deletions_asked; }
  void Deleted(const std::string& id) { jobs_.at(id).is_deleted = true; }
  // Refused because the job has ended, or because it has not.
  void CancelRefused(const std::string& id);
  void DeletionRefused(const std::string& id, const KnownJob& before);
  void Listed(const std::map<std::string, KnownJob>& before,
              const std::vector<v1::EnsembleJob>& jobs);
  // A watch sent this state.
  void Saw(const std::string& id, const KnownJob& before, v1::EnsembleJob::State state);
  // `results`: all that the job had when it was read.
  void Read(const std::string& id, const KnownJob& before,
            const std::vector<v1::PointResult>& results);
  // The finished points that a watch and the watches that it resumes have sent, and the last state.
  // What they told stays true.
  void Watched(const std::string& id, const std::vector<v1::PointResult>& points,
               v1::EnsembleJob::State state);

  // For the last phase, in which nothing fails.
  void ExpectAllEnded() const;

 private:
  void NoteState(const std::string& id, const v1::EnsembleJob& job);
  void CheckKeys(const std::set<std::string>& listed) const;
  void CheckResult(const std::string& id, const Question& question, const v1::PointResult& result);
  const v1::PointResult& Undisturbed(const Question& question, int point);
  double SamplesOf(const Question& question);

  std::map<std::string, KnownJob> jobs_;                             // by id
  std::map<std::string, std::string> by_key_;                        // ids of requests with a key
  std::map<std::pair<uint64_t, int>, v1::PointResult> undisturbed_;  // by seed and point
};

}  // namespace ballpiston::server
