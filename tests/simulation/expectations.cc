#include "tests/simulation/expectations.h"

#include "core/ensemble/point_fold.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/errors.h"
#include "server/convert/point_result.h"
#include "server/convert/spec.h"
#include "server/store/job_name.h"
#include "server/store/job_record.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"

namespace ballpiston::server {
namespace {

using State = v1::EnsembleJob::State;

// For the mean of a uniform law. Some points of about 100 blocks reach it.
constexpr double kTolerance = 0.03;

std::string Text(State state) { return v1::EnsembleJob::State_Name(state); }

v1::PointResult ResultOfAnUndisturbedRun(const Question& question, int point) {
  const EnsembleSpec spec = CheckSpec(SpecOf(question)).spec;
  const auto index = static_cast<size_t>(point);
  const auto experiment = FakeExperiments()(spec, index);
  LocalPoint computed(*experiment);
  while (const std::optional<Block> block = computed.NextBlock()) {
    computed.Add(*block, RunBlock(*experiment, *block));
  }
  return ResultOf(index, *experiment, experiment->Summarize(computed.Merged()));
}

// Without histograms and curves, which watches do not send.
std::string BytesOf(v1::PointResult result) {
  result.clear_histograms();
  result.clear_curves();
  return DeterministicBytes(result);
}

}  // namespace

v1::EnsembleSpec SpecOf(const Question& question) {
  v1::EnsembleSpec spec = Equilibrium(question.points, question.blocks, question.seed);
  if (question.has_tolerance) spec.mutable_target()->set_tolerance(kTolerance);
  return spec;
}

Question QuestionOf(uint64_t seed) {
  const bool has_tolerance = seed % 3 == 0;
  return {.seed = seed,
          .points = static_cast<int>(1 + seed % 4),
          .blocks = static_cast<int64_t>(1 + seed * 7 % (has_tolerance ? 300 : 60)),
          .has_tolerance = has_tolerance,
          .has_key = seed >= kFirstKeyedSeed,
          .crashes = seed == kFirstKeyedSeed + 6 || seed == kFirstKeyedSeed + 9};
}

std::vector<std::string> Expectations::Ids() const {
  std::vector<std::string> ids;
  for (const auto& [id, job] : jobs_) ids.push_back(id);
  return ids;
}

KnownJob Expectations::Known(const std::string& id) const {
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? KnownJob() : found->second;
}

void Expectations::Created(const std::map<std::string, KnownJob>& before, const std::string& key,
                           const Question& question, const v1::EnsembleJob& job) {
  const std::string id = *JobIdOf(job.name());
  const auto [known, is_new] = jobs_.try_emplace(id, KnownJob{.question = question});
  if (known->second.question.seed != question.seed) {
    throw Violation("another question", id, absl::StrCat("answers the question ", question.seed));
  }
  const auto then = before.find(id);
  if (then != before.end() && then->second.is_deleted) {
    throw Violation("deleted", id, "answers a request although it was deleted");
  }
  NoteState(id, job);
  // A job that is deleted meanwhile may still answer.
  if (key.empty() || known->second.deletions_asked > 0) return;
  const auto [first, is_first] = by_key_.try_emplace(key, id);
  const bool is_gone = jobs_.at(first->second).deletions_asked > 0;
  if (first->second != id && !is_gone) {
    throw Violation("second job", id, absl::StrCat("is the job of a retry, after ", first->second));
  }
  first->second = id;
}

void Expectations::Got(const KnownJob& before, const v1::EnsembleJob& job) {
  const std::string id = *JobIdOf(job.name());
  if (before.is_deleted) throw Violation("deleted", id, "exists again");
  Saw(id, before, job.state());
  if (job.progress().points_done() < before.points_done) {
    throw Violation(
        "progress", id,
        absl::StrCat(job.progress().points_done(), " points after ", before.points_done));
  }
  if (before.is_cancelled && job.state() < v1::EnsembleJob::CANCELLING) {
    throw Violation("cancelled", id, absl::StrCat(Text(job.state()), " after its cancellation"));
  }
  NoteState(id, job);
}

void Expectations::Saw(const std::string& id, const KnownJob& before, State state) {
  const bool is_older = state < before.state || (HasEnded(before.state) && state != before.state);
  if (is_older) {
    throw Violation("states", id, absl::StrCat(Text(state), " after ", Text(before.state)));
  }
  if (before.has_ended && !HasEnded(state)) {
    throw Violation("states", id,
                    absl::StrCat(Text(state), " after a refusal that said that the job has ended"));
  }
}

void Expectations::NoteState(const std::string& id, const v1::EnsembleJob& job) {
  KnownJob& known = jobs_.at(id);
  const Question& question = known.question;
  known.state = std::max(known.state, job.state());
  known.points_done = std::max(known.points_done, job.progress().points_done());
  const bool may_fail = question.crashes && ReasonOf(job.error()) == "ENGINE_CRASHED";
  if (job.state() == v1::EnsembleJob::FAILED && !may_fail) {
    throw Violation("failed", id, job.error().message());
  }
  if (job.state() == v1::EnsembleJob::CANCELLED && known.cancels_asked == 0) {
    throw Violation("cancelled", id, "is cancelled, which nobody asked for");
  }
  const double all = SamplesOf(question);
  const double samples = job.progress().samples();
  if (samples > all) throw Violation("samples", id, absl::StrCat(samples, " of ", all));
  if (job.state() != v1::EnsembleJob::SUCCEEDED) return;
  if (samples != all || job.progress().points_done() != question.points) {
    throw Violation("samples", id, absl::StrCat("has succeeded with ", samples, " of ", all));
  }
}

// Without a violation, a deletion has taken effect that had no answer.
void Expectations::Missed(const std::string& id) {
  if (Known(id).deletions_asked == 0) throw Violation("lost", id, "is not found");
  if (const auto job = jobs_.find(id); job != jobs_.end()) job->second.is_deleted = true;
}

void Expectations::CancelRefused(const std::string& id) {
  --jobs_.at(id).cancels_asked;
  jobs_.at(id).has_ended = true;
}

void Expectations::DeletionRefused(const std::string& id, const KnownJob& before) {
  --jobs_.at(id).deletions_asked;
  if (HasEnded(before.state) || before.has_ended) {
    throw Violation("states", id, "is called active after its end");
  }
}

void Expectations::Listed(const std::map<std::string, KnownJob>& before,
                          const std::vector<v1::EnsembleJob>& jobs) {
  std::set<std::string> found;
  for (const v1::EnsembleJob& job : jobs) {
    const std::string id = *JobIdOf(job.name());
    if (!found.insert(id).second) throw Violation("list", id, "is in the list twice");
    // A job whose Create had no answer becomes known here.
    jobs_.try_emplace(id, KnownJob{.question = QuestionOf(job.spec().seed())});
    Got(before.contains(id) ? before.at(id) : KnownJob(), job);
  }
  for (const auto& [id, known] : before) {
    if (!found.contains(id) && !known.is_deleted) Missed(id);
  }
  CheckKeys(found);
}

// A request with a key has one job, however often it is retried.
void Expectations::CheckKeys(const std::set<std::string>& listed) const {
  std::map<uint64_t, std::string> of_seed;
  for (const std::string& id : listed) {
    const KnownJob job = Known(id);
    if (!job.question.has_key || job.deletions_asked > 0) continue;
    const auto [first, is_first] = of_seed.try_emplace(job.question.seed, id);
    if (!is_first) throw Violation("second job", id, absl::StrCat("and ", first->second));
  }
}

void Expectations::Read(const std::string& id, const KnownJob& before,
                        const std::vector<v1::PointResult>& results) {
  if (before.is_deleted) throw Violation("deleted", id, "has results again");
  const Question question = Known(id).question;
  std::set<int> points;
  for (const v1::PointResult& result : results) {
    CheckResult(id, question, result);
    if (!points.insert(result.index()).second) throw Violation("results", id, "has a point twice");
  }
  if (static_cast<int>(points.size()) < before.points_done) {
    throw Violation("results", id,
                    absl::StrCat("has ", points.size(), " results after ", before.points_done));
  }
}

void Expectations::CheckResult(const std::string& id, const Question& question,
                               const v1::PointResult& result) {
  v1::PointResult expected = Undisturbed(question, result.index());
  expected.set_name(ResultName(id, result.index()));
  if (BytesOf(result) != BytesOf(expected)) {
    throw Violation(
        "bytes", id,
        absl::StrCat("point ", result.index(), " has other bytes: ", result.ShortDebugString()));
  }
}

const v1::PointResult& Expectations::Undisturbed(const Question& question, int point) {
  const auto [result, is_new] = undisturbed_.try_emplace({question.seed, point});
  if (is_new) result->second = ResultOfAnUndisturbedRun(question, point);
  return result->second;
}

double Expectations::SamplesOf(const Question& question) {
  double samples = 0;
  for (int point = 0; point < question.points; ++point) {
    samples += static_cast<double>(Undisturbed(question, point).samples());
  }
  return samples;
}

void Expectations::Watched(const std::string& id, const std::vector<v1::PointResult>& points,
                           State state) {
  const Question question = Known(id).question;
  std::set<int> told;
  for (const v1::PointResult& point : points) {
    CheckResult(id, question, point);
    if (!told.insert(point.index()).second) {
      throw Violation("watch", id, absl::StrCat("point ", point.index(), " was sent twice"));
    }
  }
  KnownJob& known = jobs_.at(id);
  known.state = std::max(known.state, state);
  known.points_done = std::max(known.points_done, static_cast<int>(told.size()));
  if (state == v1::EnsembleJob::SUCCEEDED && static_cast<int>(told.size()) != question.points) {
    throw Violation("watch", id,
                    absl::StrCat(told.size(), " of ", question.points, " points were sent"));
  }
}

void Expectations::ExpectAllEnded() const {
  for (const auto& [id, job] : jobs_) {
    if (!job.is_deleted && !HasEnded(job.state)) {
      throw Violation("end", id, absl::StrCat("does not end: ", Text(job.state)));
    }
    if (job.is_cancelled && job.state != v1::EnsembleJob::CANCELLED && !job.is_deleted) {
      throw Violation("cancelled", id, absl::StrCat("ended as ", Text(job.state)));
    }
  }
}

}  // namespace ballpiston::server
