#include "server/worker/lease_record.h"

#include <algorithm>
#include <cassert>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/engine_version.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_fold.h"
#include "server/convert/fold_record.h"

namespace ballpiston::server {
namespace {

absl::Status DamagedRecord(absl::string_view field, absl::string_view why) {
  return absl::DataLossError(absl::StrCat("field ", field, " of a lease ", why));
}

// ---- the question ----

storage::Question::Model ModelRecord(Model model) {
  switch (model) {
    case Model::kMarkov:
      return storage::Question::MARKOV;
    case Model::kBilliard:
      return storage::Question::BILLIARD;
    case Model::kBilliardReference:
      return storage::Question::BILLIARD_REFERENCE;
    case Model::kAuto:
    case Model::kClosedForm:
    case Model::kSpectrum:
      break;
  }
  return storage::Question::MODEL_UNSPECIFIED;
}

// Empty if the number is not a model that samples.
std::optional<Model> ModelOf(storage::Question::Model record) {
  switch (record) {
    case storage::Question::MARKOV:
      return Model::kMarkov;
    case storage::Question::BILLIARD:
      return Model::kBilliard;
    case storage::Question::BILLIARD_REFERENCE:
      return Model::kBilliardReference;
    default:
      return std::nullopt;
  }
}

void FillTarget(const Target& target, storage::Question& record) {
  if (target.samples) record.set_samples(*target.samples);
  if (target.collisions) record.set_collisions(*target.collisions);
  if (target.tolerance) record.set_tolerance(*target.tolerance);
  record.set_estimate(target.estimate);
}

Target TargetOf(const storage::Question& record) {
  Target target = {.estimate = record.estimate()};
  switch (record.target_case()) {
    case storage::Question::kSamples:
      target.samples = record.samples();
      break;
    case storage::Question::kCollisions:
      target.collisions = record.collisions();
      break;
    case storage::Question::kTolerance:
      target.tolerance = record.tolerance();
      break;
    case storage::Question::TARGET_NOT_SET:
      break;
  }
  return target;
}

void FillPoint(const Grid& grid, storage::Question& record) {
  for (const Parameter* parameter : kParameters) {
    for (const double value : grid[*parameter]) {
      storage::Value& added = *record.add_point();
      added.set_parameter(static_cast<uint32_t>(parameter->index));
      added.set_value(value);
    }
  }
}

absl::StatusOr<Grid> PointOf(const storage::Question& record) {
  Grid grid;
  for (const storage::Value& value : record.point()) {
    if (value.parameter() >= kParameters.size()) {
      return DamagedRecord("question.point.parameter",
                           absl::StrCat("is ", value.parameter(), ", an unknown parameter"));
    }
    std::vector<double>& list = grid[*kParameters[value.parameter()]];
    if (!list.empty()) return DamagedRecord("question.point", "has a parameter twice");
    list.push_back(value.value());
  }
  return grid;
}

// AUTO may choose the jump process for a spec in single precision, which a user may not. So the
// rest of the spec is checked with model AUTO, and with `verify`, because the answer is sampled.
absl::Status CheckRest(EnsembleSpec spec) {
  spec.model = Model::kAuto;
  spec.verify = true;
  const std::vector<FieldViolation> found = Violations(spec);
  if (found.empty()) return absl::OkStatus();
  return DamagedRecord(absl::StrCat("question.", found[0].field), found[0].description);
}

// The rest of the spec has no violations.
absl::Status CheckModel(const EnsembleSpec& spec) {
  if (!AimOf(spec).IsAnsweredBy(spec.model)) {
    return DamagedRecord(
        "question.model",
        absl::StrCat("is ", Name(spec.model), ", which cannot answer ", spec.experiment->name));
  }
  if (spec.model == Model::kBilliardReference && spec.precision == Precision::kSingle) {
    return DamagedRecord("question.single_precision",
                         "is set although the model has double precision");
  }
  return absl::OkStatus();
}

// ---- the chunks ----

absl::Status CheckChunks(const storage::Lease& record, const ChunkPlan& plan) {
  if (record.first_chunk() >= plan.chunks()) {
    return DamagedRecord(
        "first_chunk",
        absl::StrCat("is ", record.first_chunk(), ", but the plan has ", plan.chunks(), " chunks"));
  }
  if (record.end_chunk() <= record.first_chunk() || record.end_chunk() > plan.chunks()) {
    return DamagedRecord("end_chunk", absl::StrCat("is ", record.end_chunk(),
                                                   "; permitted: ", record.first_chunk() + 1,
                                                   " to ", plan.chunks()));
  }
  const uint64_t blocks = plan.BlocksIn(record.first_chunk());
  if (record.blocks() < blocks) return absl::OkStatus();
  return DamagedRecord("blocks",
                       absl::StrCat("is ", record.blocks(), ", but the chunk has ", blocks,
                                    " blocks, and one or more is to be computed"));
}

// The blocks are those of a fold whose complete chunks are possible.
absl::Status CheckPartial(const PointExperiment& experiment, const PartialChunk& start) {
  FoldState state = {.chunk = start.chunk, .blocks = start.blocks, .partial = start.merged};
  if (start.chunk > 0) state.complete = experiment.EmptyResult();
  state.chunk_digests.resize(start.chunk);
  const bool is_possible =
      start.blocks == 0 ? start.merged == BlockResult() : CheckFoldState(experiment, state).ok();
  if (is_possible) return absl::OkStatus();
  return DamagedRecord("partial", "is not a result of the lease's experiment");
}

// The chunks start from states that the experiment can continue, or in the first stage.
absl::Status CheckGroups(const PointExperiment& experiment, const Lease& lease) {
  const uint64_t groups = experiment.plan().groups();
  bool is_possible = lease.groups.empty() || lease.groups.size() == groups;
  for (uint64_t chunk = lease.start.chunk; chunk < std::min(lease.end, lease.start.chunk + groups);
       ++chunk) {
    const GroupState start =
        lease.groups.empty() || !is_possible ? GroupState() : lease.groups[chunk % groups];
    is_possible &= chunk < groups ? start.empty() : experiment.CanContinue(start);
  }
  if (is_possible) return absl::OkStatus();
  return DamagedRecord("groups", "has no state from which the lease's experiment can continue");
}

double PredictedSeconds(const ChunkPlan& plan, const Lease& lease) {
  const uint64_t begin = plan.BlockAt(lease.start.chunk, lease.start.blocks).first;
  return plan.SecondsFor(static_cast<double>(plan.SamplesBefore(lease.end) - begin));
}

// Everything but the question, which gave `spec`.
absl::StatusOr<Lease> ChunksOf(const storage::Lease& record, EnsembleSpec spec) {
  Lease lease;
  lease.experiment = PointExperiment::Create(spec, 0);
  lease.spec = std::make_shared<const EnsembleSpec>(std::move(spec));
  absl::Status checked = CheckChunks(record, lease.experiment->plan());
  if (!checked.ok()) return checked;
  lease.attempt = record.attempt();
  lease.crashes = record.crashes();
  lease.point = static_cast<size_t>(record.point());
  lease.start = {record.first_chunk(), record.blocks(), ResultOfAccumulators(record.partial())};
  lease.end = record.end_chunk();
  lease.seconds = PredictedSeconds(lease.experiment->plan(), lease);
  for (const storage::Group& group : record.groups()) lease.groups.push_back(GroupOf(group));
  checked = CheckPartial(*lease.experiment, lease.start);
  if (checked.ok()) checked = CheckGroups(*lease.experiment, lease);
  if (!checked.ok()) return checked;
  return lease;
}

absl::Status CheckIdentity(const storage::Lease& record) {
  if (record.engine_version() != kEngineVersion) {
    return absl::UnimplementedError(
        absl::StrCat("a lease is for engine version ", record.engine_version(),
                     "; this program has engine version ", kEngineVersion));
  }
  if (record.point() < 0 || record.point() >= kMaxPoints) {
    return DamagedRecord("point",
                         absl::StrCat("is ", record.point(), "; permitted: 0 to ", kMaxPoints - 1));
  }
  if (record.crashes() < 0) {
    return DamagedRecord("crashes",
                         absl::StrCat("is ", record.crashes(), "; permitted: 0 or greater"));
  }
  if (record.attempt() >= 1) return absl::OkStatus();
  return DamagedRecord("attempt",
                       absl::StrCat("is ", record.attempt(), "; permitted: 1 or greater"));
}

}  // namespace

storage::Question QuestionRecord(const EnsembleSpec& one_point) {
  assert(!one_point.target.budget_seconds && one_point.purpose == Purpose::kAnswer);
  storage::Question record;
  record.set_experiment(static_cast<uint32_t>(one_point.experiment->number));
  FillPoint(one_point.grid, record);
  FillTarget(one_point.target, record);
  record.set_seed(one_point.seed);
  record.set_model(ModelRecord(one_point.model));
  record.set_single_precision(one_point.precision == Precision::kSingle);
  return record;
}

absl::StatusOr<EnsembleSpec> SpecOfQuestion(const storage::Question& question) {
  EnsembleSpec spec = {
      .experiment = FindExperiment(question.experiment()),
      .target = TargetOf(question),
      .seed = question.seed(),
      .precision = question.single_precision() ? Precision::kSingle : Precision::kDouble};
  if (spec.experiment == nullptr) {
    return DamagedRecord("question.experiment",
                         absl::StrCat("is ", question.experiment(), ", an unknown experiment"));
  }
  const std::optional<Model> model = ModelOf(question.model());
  if (!model) {
    return DamagedRecord("question.model", absl::StrCat("is ", static_cast<int>(question.model()),
                                                        ", not a model that samples"));
  }
  spec.model = *model;
  absl::StatusOr<Grid> grid = PointOf(question);
  if (!grid.ok()) return grid.status();
  spec.grid = *std::move(grid);
  absl::Status checked = CheckRest(spec);
  if (checked.ok()) checked = CheckModel(spec);
  if (!checked.ok()) return checked;
  return spec;
}

storage::Lease LeaseRecord(const Lease& lease, const JobIdentity& job) {
  storage::Lease record;
  record.set_server(job.server);
  record.set_job(job.job);
  record.set_generation(job.generation);
  record.set_engine_version(job.engine_version);
  record.set_point(static_cast<int64_t>(lease.point));
  record.set_attempt(lease.attempt);
  record.set_crashes(lease.crashes);
  const PointExperiment& experiment = *lease.experiment;
  *record.mutable_question() =
      QuestionRecord(OnePointSpec(*lease.spec, experiment.parameters(), experiment.answer().model));
  record.set_first_chunk(lease.start.chunk);
  record.set_end_chunk(lease.end);
  record.set_blocks(lease.start.blocks);
  if (lease.start.blocks > 0) FillAccumulators(lease.start.merged, *record.mutable_partial());
  for (const GroupState& group : lease.groups) FillGroup(group, *record.add_groups());
  return record;
}

absl::StatusOr<IdentifiedLease> LeaseOfRecord(const storage::Lease& record) {
  const absl::Status identified = CheckIdentity(record);
  if (!identified.ok()) return identified;
  absl::StatusOr<EnsembleSpec> spec = SpecOfQuestion(record.question());
  if (!spec.ok()) return spec.status();
  absl::StatusOr<Lease> lease = ChunksOf(record, *std::move(spec));
  if (!lease.ok()) return lease.status();
  return IdentifiedLease{
      .job = {record.server(), record.job(), record.generation(), record.engine_version()},
      .lease = *std::move(lease)};
}

}  // namespace ballpiston::server
