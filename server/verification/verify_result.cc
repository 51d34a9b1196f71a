#include "server/verification/verify_result.h"

#include <google/protobuf/util/field_comparator.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/message_differencer.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "absl/random/distributions.h"
#include "absl/strings/str_cat.h"
#include "core/ensemble/block_result.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "server/convert/point_result.h"
#include "server/convert/spec.h"
#include "server/worker/lease_runner.h"

namespace ballpiston::server {
namespace {

using google::protobuf::util::DefaultFieldComparator;
using google::protobuf::util::MessageDifferencer;

// Closed forms and the spectrum use the C library and Eigen, whose last digits depend on the
// machine. A z-score is a small difference, which multiplies such an error by value/error.
constexpr double kRoundingFraction = 1e-9;
constexpr double kZScoreMargin = 1e-6;

absl::StatusOr<v1::SavedResult> ReadSaved(const std::string& file) {
  std::error_code error;
  const uintmax_t size =
      std::filesystem::file_size(file, error);  // an error for a folder or device
  std::string text(error ? 0 : size, '\0');
  std::ifstream in(file, std::ios::binary);
  if (error || !in.read(text.data(), static_cast<std::streamsize>(size))) {
    return absl::InvalidArgumentError(absl::StrCat("--verify: cannot read the file ", file));
  }
  v1::SavedResult saved;
  google::protobuf::util::JsonParseOptions options;
  options.ignore_unknown_fields = true;
  const auto parsed = google::protobuf::util::JsonStringToMessage(text, &saved, options);
  if (parsed.ok() && saved.has_job()) return saved;
  return absl::InvalidArgumentError(absl::StrCat(
      "--verify: ", file, " is not a result that `ballpiston result --save FILE.json` wrote",
      parsed.ok() ? "" : absl::StrCat(": ", std::string(parsed.message()))));
}

std::optional<Model> ModelOf(v1::EnsembleSpec::Model message) {
  for (const Model model : {Model::kClosedForm, Model::kSpectrum, Model::kMarkov, Model::kBilliard,
                            Model::kBilliardReference}) {
    if (ModelMessage(model) == message) return model;
  }
  return std::nullopt;
}

// A point of the file, and how the engine computes it.
struct SavedPoint {
  v1::PointResult result;
  const ExperimentKind* kind;
  std::unique_ptr<const PointExperiment> experiment;
  bool has_fixed_size;  // the number of samples follows from the specification
  std::string name;     // "ensembleJobs/ID, point 3"
};

uint64_t ChunksOf(const SavedPoint& point) {
  return static_cast<uint64_t>(point.result.chunk_digests_size());
}

absl::Status Differs(const SavedPoint& point, const std::string& difference) {
  return absl::DataLossError(
      absl::StrCat(point.name, ": the file is not what this engine computes: ", difference));
}

absl::StatusOr<SavedPoint> PointOf(const v1::SavedResult& saved, int which) {
  const v1::PointResult& result = saved.points(which);
  SavedPoint point = {result, nullptr, nullptr, false,
                      absl::StrCat(saved.job().name(), ", point ", result.index())};
  const CheckedSpec checked = CheckSpec(saved.job().spec());
  if (!checked.violations.empty()) {
    return absl::InvalidArgumentError(absl::StrCat("the file's ", checked.violations[0].field, ": ",
                                                   checked.violations[0].description));
  }
  const EnsembleSpec& spec = checked.spec;
  const auto index = static_cast<size_t>(result.index());
  if (result.index() < 0 || index >= PointCount(spec)) {
    return Differs(point, absl::StrCat("the grid has ", PointCount(spec), " points"));
  }
  const v1::PointParameters parameters = ParametersMessage(PointAt(spec, index));
  if (!MessageDifferencer::Equals(parameters, result.parameters())) {
    return Differs(point, "the point of the specification has other parameters");
  }
  const std::optional<Model> model = ModelOf(result.model());
  if (!model || !spec.experiment->IsAnsweredBy(*model)) {
    return Differs(point, "the experiment is not answered by this model");
  }
  if (spec.model != Model::kAuto && spec.model != *model) {
    return Differs(point, "the specification names another model");
  }
  point.kind = spec.experiment;
  point.has_fixed_size = !spec.target.budget_seconds;
  point.experiment = PointExperiment::Create(spec, index, {.model = *model});
  if (ChunksOf(point) > point.experiment->plan().chunks()) {
    return Differs(point, absl::StrCat("the plan has ", point.experiment->plan().chunks(),
                                       " chunks, the file has ", ChunksOf(point)));
  }
  return point;
}

// ---- a whole point ----

// Without the fields that depend on pilots, or on the rounding of the C library's functions.
v1::PointResult Comparable(v1::PointResult result) {
  result.clear_reason();
  for (v1::Estimate& estimate : *result.mutable_estimates()) estimate.clear_model_error();
  return result;
}

class ChunksUpTo : public BlockQueue {
 public:
  ChunksUpTo(LocalPoint& point, uint64_t end) : point_(point), end_(end) {}

  std::optional<Block> Next() override {
    if (is_over_) return std::nullopt;
    const std::optional<Block> block = point_.NextBlock();
    is_over_ = block && block->chunk >= end_;
    return is_over_ ? std::nullopt : block;
  }
  void Done(const Block& block, BlockResult result) override {
    point_.Add(block, std::move(result));
  }
  bool Pause() override { return false; }
  std::stop_token stop() const override { return {}; }

 private:
  LocalPoint& point_;
  const uint64_t end_;
  bool is_over_ = false;
};

absl::StatusOr<std::string> VerifyWhole(const SavedPoint& point) {
  const PointExperiment& experiment = *point.experiment;
  FoldState state;
  BlockResult merged;
  if (experiment.plan().samples() > 0) {
    // Not more chunks than the file has, so that a wrong file does not take longer than a right
    // one.
    LocalPoint local(experiment);
    ChunksUpTo queue(local, ChunksOf(point));
    experiment.StartRun(queue)->Advance();
    if (!local.finished()) return Differs(point, "the point has more chunks than the file");
    state = local.State();
    merged = local.Merged();
  }
  const PointSummary summary = experiment.Summarize(merged);
  const v1::PointResult computed =
      WithDetails(ResultOf(static_cast<size_t>(point.result.index()), experiment, summary),
                  DetailsOf(summary, state.chunk_digests), *point.kind);

  DefaultFieldComparator rounded;
  rounded.set_float_comparison(DefaultFieldComparator::APPROXIMATE);
  rounded.SetDefaultFractionAndMargin(kRoundingFraction, 0);
  const auto* z_score = v1::Estimate::descriptor()->FindFieldByName("z_score");
  rounded.SetFractionAndMargin(z_score, kRoundingFraction, kZScoreMargin);
  // Counts are whole numbers, and computed exactly.
  const auto* counts = v1::Histogram::descriptor()->FindFieldByName("counts");
  const auto* samples = v1::PointResult::descriptor()->FindFieldByName("samples");
  rounded.SetFractionAndMargin(counts, 0, 0);
  rounded.SetFractionAndMargin(samples, 0, 0);
  std::string difference;
  MessageDifferencer differencer;
  differencer.set_field_comparator(&rounded);
  differencer.ReportDifferencesToString(&difference);
  if (!differencer.Compare(Comparable(computed), Comparable(point.result))) {
    return Differs(point, difference.substr(0, difference.find('\n')));
  }
  return absl::StrCat(point.name, ": computed again as a whole, ", summary.samples, " samples in ",
                      state.chunk_digests.size(), " chunks; everything is equal");
}

// ---- a chunk ----

class OneChunk : public ChunkReceiver {
 public:
  void ChunkDone(size_t, ChunkResult chunk) override { result = std::move(chunk.result); }
  void Worked(size_t, double) override {}

  BlockResult result;
};

absl::StatusOr<std::string> VerifyChunk(const SavedPoint& point, absl::BitGenRef random) {
  const uint64_t chunks = ChunksOf(point);
  const auto chunk = absl::Uniform<uint64_t>(random, 0, chunks);
  LeaseWork work;
  // Shared with nobody: the lease wants a shared pointer.
  work.lease.experiment = {std::shared_ptr<void>(), point.experiment.get()};
  work.lease.start = {.chunk = chunk};
  work.lease.end = chunk + 1;
  OneChunk computed;
  RunLeases({work}, {}, computed);
  const uint64_t digest = DigestOf(computed.result);
  const uint64_t saved = point.result.chunk_digests(static_cast<int>(chunk));
  if (digest != saved) {
    return Differs(point, absl::StrCat("the digest of chunk ", chunk, " is ", saved,
                                       " in the file and ", digest, " computed again"));
  }
  return absl::StrCat(point.name, ": chunk ", chunk, " of ", chunks, " computed again, ",
                      computed.result.samples,
                      " samples; the bits are equal (a chunk of a long point: "
                      "estimates, histograms and curves were not compared)");
}

}  // namespace

absl::StatusOr<std::string> VerifySaved(const v1::SavedResult& saved, absl::BitGenRef random,
                                        double whole_seconds) {
  if (saved.points().empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--verify: the file has no finished point of ", saved.job().name()));
  }
  if (saved.job().engine_version() != EngineVersion()) {
    return absl::FailedPreconditionError(
        absl::StrCat("engine ", saved.job().engine_version(), " computed ", saved.job().name(),
                     ", and this is engine ", EngineVersion(),
                     ": versions of the engine give different bits. Verify it with a ballpistond "
                     "that has engine ",
                     saved.job().engine_version()));
  }
  const absl::StatusOr<SavedPoint> point =
      PointOf(saved, absl::Uniform(random, 0, saved.points_size()));
  if (!point.ok()) return point.status();
  const ChunkPlan& plan = point->experiment->plan();
  if (plan.samples() == 0) return VerifyWhole(*point);
  if (point->result.chunk_digests().empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(point->name, ": the file has no digests of chunks to compare with"));
  }
  const double seconds = plan.SecondsFor(static_cast<double>(plan.SamplesBefore(ChunksOf(*point))));
  if (seconds <= whole_seconds && point->has_fixed_size) return VerifyWhole(*point);
  return VerifyChunk(*point, random);
}

absl::StatusOr<std::string> VerifyResult(const std::string& file, absl::BitGenRef random) {
  const absl::StatusOr<v1::SavedResult> saved = ReadSaved(file);
  return saved.ok() ? VerifySaved(*saved, random) : saved.status();
}

}  // namespace ballpiston::server
