// The reference model: which answers a call may have, given the earlier calls and their answers.
//
// An answer is compared with what was known when its call began, because calls overlap and a call
// without an answer may or may not have taken effect. A wrong answer throws Violation.
#pragma once

#include "ballpiston/v1/ensemble.pb.h"
#include "core/ensemble/point_fold.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/errors.h"
#include "server/convert/point_result.h"
#include "server/convert/spec.h"
#include "server/store/job_name.h"
#include "server/store/job_record.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"
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

// Every client derives a question from its seed in this way: one of 1 to kSeedsWithoutKey, or of
// the kKeys seeds from kFirstKeyedSeed on, which have a key.
inline constexpr uint64_t kSeedsWithoutKey = 6, kFirstKeyedSeed = 1000, kKeys = 12;
inline constexpr uint64_t kFirstCrash = kFirstKeyedSeed + 6, kSecondCrash = kFirstKeyedSeed + 9;
static_assert(kSecondCrash < kFirstKeyedSeed + kKeys);

inline Question QuestionOf(uint64_t seed) {
  const bool has_tolerance = seed % 3 == 0;
  return {.seed = seed,
          .points = static_cast<int>(1 + seed % 4),
          .blocks = static_cast<int64_t>(1 + seed * 7 % (has_tolerance ? 300 : 60)),
          .has_tolerance = has_tolerance,
          .has_key = seed >= kFirstKeyedSeed,
          .crashes = seed == kFirstCrash || seed == kSecondCrash};
}

inline v1::EnsembleSpec SpecOf(const Question& question) {
  // For the mean of a uniform law. Some points of about 100 blocks reach it.
  constexpr double kTolerance = 0.03;
  v1::EnsembleSpec spec = Equilibrium(question.points, question.blocks, question.seed);
  if (question.has_tolerance) spec.mutable_target()->set_tolerance(kTolerance);
  return spec;
}

struct Violation : std::runtime_error {
  Violation(const std::string& check, const std::string& job, const std::string& what)
      : std::runtime_error(check + ": " + job + " " + what), check(check), job(job) {}

  std::string check;  // names the promise
  std::string job;    // empty if the promise is not about one job
};

// `job`: as above. `what` says what is wrong.
template <typename... What>
void Require(bool is_so, const char* check, const std::string& job, const What&... what) {
  if (!is_so) throw Violation(check, job, absl::StrCat(what...));
}

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
using KnownJobs = std::map<std::string, KnownJob>;  // by id, including deleted jobs

class Expectations {
 public:
  using State = v1::EnsembleJob::State;

  const KnownJobs& all() const { return jobs_; }
  std::vector<std::string> Ids() const {
    std::vector<std::string> ids;
    for (const auto& [id, job] : jobs_) ids.push_back(id);
    return ids;
  }
  // The facts about the job up to now. If no answer named this id, the KnownJob has no facts.
  KnownJob Known(const std::string& id) const { return KnownIn(jobs_, id); }

  // ---- answers of calls that began when `before` was known ----

  // The answer may be the first that names the job, because Create may have had no answer.
  void Named(const KnownJobs& before, const Question& question, const v1::EnsembleJob& job) {
    const std::string id = *JobIdOf(job.name());
    const auto [known, is_new] = jobs_.try_emplace(id, KnownJob{.question = question});
    Require(known->second.question.seed == question.seed, "another question", id,
            "answers the question ", question.seed);
    Got(KnownIn(before, id), job);
    CheckOnlyJob(id, known->second);
  }

  void Got(const KnownJob& before, const v1::EnsembleJob& job) {
    const std::string id = *JobIdOf(job.name());
    Require(!before.is_deleted, "deleted", id, "exists again");
    Saw(id, before, job.state());
    Require(job.progress().points_done() >= before.points_done, "progress", id,
            job.progress().points_done(), " points after ", before.points_done);
    Require(!before.is_cancelled || job.state() >= v1::EnsembleJob::CANCELLING, "cancelled", id,
            Text(job.state()), " after its cancellation");
    NoteState(id, job);
  }

  // The job was not found, or was not in the list. A violation, unless a deletion was requested and
  // has taken effect without an answer.
  void Missed(const std::string& id) {
    Require(Known(id).deletions_asked > 0, "lost", id, "is not found");
    jobs_.at(id).is_deleted = true;
  }

  void AskedToCancel(const std::string& id) { ++jobs_.at(id).cancels_asked; }
  void Cancelled(const std::string& id) { jobs_.at(id).is_cancelled = true; }
  void AskedToDelete(const std::string& id) { ++jobs_.at(id).deletions_asked; }
  void Deleted(const std::string& id) { jobs_.at(id).is_deleted = true; }

  // Refused because the job has ended.
  void CancelRefused(const std::string& id) {
    --jobs_.at(id).cancels_asked;
    jobs_.at(id).has_ended = true;
  }
  // Refused because the job has not ended.
  void DeletionRefused(const std::string& id, const KnownJob& before) {
    --jobs_.at(id).deletions_asked;
    Require(!HasEnded(before.state) && !before.has_ended, "states", id,
            "is called active after its end");
  }

  void Listed(const KnownJobs& before, const std::vector<v1::EnsembleJob>& jobs) {
    std::set<std::string> found;
    for (const v1::EnsembleJob& job : jobs) {
      const std::string id = *JobIdOf(job.name());
      Require(found.insert(id).second, "list", id, "is in the list twice");
      Named(before, QuestionOf(job.spec().seed()), job);
    }
    for (const auto& [id, known] : before) {
      if (!found.contains(id) && !known.is_deleted) Missed(id);
    }
  }

  // An answer or a watch message has this state.
  void Saw(const std::string& id, const KnownJob& before, State state) const {
    const bool is_older = state < before.state || (HasEnded(before.state) && state != before.state);
    Require(!is_older, "states", id, Text(state), " after ", Text(before.state));
    Require(!before.has_ended || HasEnded(state), "states", id, Text(state),
            " after a refusal that said that it has ended");
  }

  // `results`: all that the job had when it was read.
  void Read(const std::string& id, const KnownJob& before,
            const std::vector<v1::PointResult>& results) {
    Require(!before.is_deleted, "deleted", id, "has results again");
    const int points = CountPoints("results", id, results);
    Require(points >= before.points_done, "results", id, "has ", points, " results after ",
            before.points_done);
  }

  // The finished points that a watch and the watches that it resumes have sent, and the last state.
  // What they told stays true.
  void Watched(const std::string& id, const std::vector<v1::PointResult>& points, State state) {
    const int told = CountPoints("watch", id, points);
    KnownJob& known = jobs_.at(id);
    known.state = std::max(known.state, state);
    known.points_done = std::max(known.points_done, told);
    Require(state != v1::EnsembleJob::SUCCEEDED || told == known.question.points, "watch", id, told,
            " of ", known.question.points, " points were sent");
  }

  // For the last phase, in which nothing fails.
  void ExpectAllEnded() const {
    for (const auto& [id, job] : jobs_) {
      if (job.is_deleted) continue;
      Require(HasEnded(job.state), "end", id, "does not end: ", Text(job.state));
      Require(!job.is_cancelled || job.state == v1::EnsembleJob::CANCELLED, "cancelled", id,
              "ended as ", Text(job.state));
    }
  }

 private:
  static std::string Text(State state) { return v1::EnsembleJob::State_Name(state); }

  static KnownJob KnownIn(const KnownJobs& jobs, const std::string& id) {
    const auto found = jobs.find(id);
    return found == jobs.end() ? KnownJob() : found->second;
  }

  // A request with a key has one job, however often it is retried. A job that is being deleted may
  // still be named, and another may be created.
  void CheckOnlyJob(const std::string& id, const KnownJob& job) const {
    if (!job.question.has_key || job.deletions_asked > 0) return;
    for (const auto& [other, known] : jobs_) {
      const bool is_of_key = known.question.seed == job.question.seed;
      Require(other == id || !is_of_key || known.deletions_asked > 0, "second job", id, "and ",
              other);
    }
  }

  void NoteState(const std::string& id, const v1::EnsembleJob& job) {
    KnownJob& known = jobs_.at(id);
    const Question& question = known.question;
    known.state = std::max(known.state, job.state());
    known.points_done = std::max(known.points_done, job.progress().points_done());
    const bool may_fail = question.crashes && ReasonOf(job.error()) == "ENGINE_CRASHED";
    Require(job.state() != v1::EnsembleJob::FAILED || may_fail, "failed", id,
            job.error().message());
    Require(job.state() != v1::EnsembleJob::CANCELLED || known.cancels_asked > 0, "cancelled", id,
            "is cancelled, which nobody asked for");
    double all = 0;
    for (int point = 0; point < question.points; ++point) {
      all += static_cast<double>(Undisturbed(question, point).samples());
    }
    const double samples = job.progress().samples();
    Require(samples <= all, "samples", id, samples, " of ", all);
    if (job.state() != v1::EnsembleJob::SUCCEEDED) return;
    Require(samples == all && job.progress().points_done() == question.points, "samples", id,
            "has succeeded with ", samples, " of ", all);
  }

  // Checks that each result has the bytes of an undisturbed run and that no point comes twice.
  // Returns the number of points.
  int CountPoints(const char* check, const std::string& id,
                  const std::vector<v1::PointResult>& results) {
    std::set<int> points;
    for (const v1::PointResult& result : results) {
      v1::PointResult expected = Undisturbed(Known(id).question, result.index());
      expected.set_name(ResultName(id, result.index()));
      const std::string point = absl::StrCat("point ", result.index());
      if (BytesOf(result) != BytesOf(expected)) {
        throw Violation("bytes", id, point + " has other bytes: " + result.ShortDebugString());
      }
      Require(points.insert(result.index()).second, check, id, point, " comes twice");
    }
    return static_cast<int>(points.size());
  }

  // Without histograms and curves, which watches do not send.
  static std::string BytesOf(v1::PointResult result) {
    result.clear_histograms();
    result.clear_curves();
    return DeterministicBytes(result);
  }

  const v1::PointResult& Undisturbed(const Question& question, int point) {
    const auto [result, is_new] = undisturbed_.try_emplace({question.seed, point});
    if (!is_new) return result->second;
    const EnsembleSpec spec = CheckSpec(SpecOf(question)).spec;
    const auto index = static_cast<size_t>(point);
    const auto experiment = FakeExperiments()(spec, index);
    LocalPoint computed(*experiment);
    while (const std::optional<Block> block = computed.NextBlock()) {
      computed.Add(*block, RunBlock(*experiment, *block));
    }
    return result->second = ResultOf(index, *experiment, experiment->Summarize(computed.Merged()));
  }

  KnownJobs jobs_;
  std::map<std::pair<uint64_t, int>, v1::PointResult> undisturbed_;  // by seed and point
};

}  // namespace ballpiston::server
