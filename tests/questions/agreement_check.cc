#include "core/ensemble/experiment_kind.h"
#include "tests/questions/checks.h"
#include "tests/questions/questions.h"

namespace ballpiston::questions {
namespace {

constexpr double kSigmas = 5;
constexpr double kMostSamples = 1e5;
constexpr double kRounding = 1e-12;
constexpr uint64_t kMixer = 0x9e3779b97f4a7c15;  // makes seeds different

const v1::Estimate* Find(const v1::PointResult& answer, const std::string& name) {
  for (const v1::Estimate& estimate : answer.estimates()) {
    if (estimate.name() == name) return &estimate;
  }
  return nullptr;
}

using Differences = std::map<std::string, std::string>;  // their texts, by what was compared

void Compare(const std::string& what, double value, double other, double permitted,
             Differences& found) {
  const double difference = std::fabs(value - other);
  permitted += kRounding * std::max(std::fabs(value), std::fabs(other));
  if (difference <= permitted) return;
  found[what] = absl::StrFormat("%.9g and %.9g differ by %.3g, permitted %.3g", value, other,
                                difference, permitted);
}

// Model errors are known for the first estimate, or are 0. The mean of a distance between laws
// depends on the number of samples, and so does its part above the noise floor.
void CompareModels(const v1::PointResult& a, const v1::PointResult& b, Differences& found) {
  for (const v1::Estimate& of_a : a.estimates()) {
    const v1::Estimate* const of_b = Find(b, of_a.name());
    if (of_b == nullptr || !of_a.has_standard_error() || !of_b->has_standard_error()) continue;
    if (!of_a.has_model_error() || !of_b->has_model_error()) continue;
    if (of_b->has_noise_floor() && a.samples() != b.samples()) continue;
    Compare(absl::StrCat(of_a.name(), " by ", v1::EnsembleSpec::Model_Name(a.model()), " and ",
                         v1::EnsembleSpec::Model_Name(b.model())),
            of_a.value(), of_b->value(),
            kSigmas * std::hypot(of_a.standard_error(), of_b->standard_error()) +
                of_a.model_error() + of_b->model_error(),
            found);
  }
}

// The exact value is that of the model itself, but of the billiard in double precision.
void CompareWithExact(const v1::PointResult& answer, Differences& found) {
  for (const v1::Estimate& estimate : answer.estimates()) {
    if (!estimate.has_exact() || !estimate.has_standard_error()) continue;
    Compare(absl::StrCat(estimate.name(), " by ", v1::EnsembleSpec::Model_Name(answer.model()),
                         " and its exact value"),
            estimate.value(), estimate.exact(),
            kSigmas * estimate.standard_error() + estimate.model_error(), found);
  }
}

// The specification of the question by one model, with as many samples as it computes in the time.
std::optional<EnsembleSpec> ByModel(const EnsembleSpec& question, Model model, uint64_t round,
                                    const Machine& machine, double seconds) {
  EnsembleSpec spec = OnePointSpec(question, PointAt(question, 0), model);
  spec.verify = false;
  spec.seed = question.seed + kMixer * (1 + round * 8 + static_cast<uint64_t>(model));
  spec = WithSamples(spec, kDefaultSamples);
  if (!Violations(spec).empty()) return std::nullopt;
  if (!TakesSamples(model)) return spec;
  const double samples = SamplesIn(seconds, spec, 0, model, machine);
  if (!(samples >= kEnoughSamples)) return std::nullopt;
  return WithSamples(spec, std::min(samples, kMostSamples));
}

std::vector<v1::PointResult> Answers(const EnsembleSpec& question, uint64_t round,
                                     const Machine& machine, double seconds) {
  std::vector<v1::PointResult> answers;
  for (const Model model : question.experiment->models()) {
    const auto spec = ByModel(question, model, round, machine, seconds);
    if (!spec) continue;
    const Answer answer = ChooseAnswer(*spec, PointAt(*spec, 0), machine);
    v1::PointResult result = ComputePoint(*spec, 0, answer);
    const bool is_enough = !TakesSamples(model) || result.samples() >= kEnoughSamples;
    if (is_enough) answers.push_back(std::move(result));
  }
  return answers;
}

}  // namespace

Differences Disagreements(const std::vector<v1::PointResult>& answers) {
  Differences found;
  for (size_t i = 0; i < answers.size(); ++i) {
    CompareWithExact(answers[i], found);
    for (size_t j = i + 1; j < answers.size(); ++j) CompareModels(answers[i], answers[j], found);
  }
  return found;
}

void CheckAgreement(const EnsembleSpec& spec, const Machine& machine, double most_seconds) {
  const Differences first = Disagreements(Answers(spec, 0, machine, most_seconds));
  if (first.empty()) return;
  for (const auto& [what, difference] :
       Disagreements(Answers(spec, 1, machine, 4 * most_seconds))) {
    Require(!first.contains(what), "agreement", what, ": ", difference);
  }
}

}  // namespace ballpiston::questions
