#include "tests/questions/question.h"

#include <google/protobuf/util/message_differencer.h>

#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/command/command_line.h"
#include "client/output/json.h"
#include "client/output/number_text.h"
#include "client/output/spelling.h"

namespace ballpiston::questions {
namespace {

using Words = std::vector<std::string>;

template <typename List>
void AddNumbers(const char* flag, const List& numbers, Words& words) {
  if (numbers.empty()) return;
  // In one word, because a negative number would look like a flag.
  words.push_back(
      absl::StrCat(flag, "=", absl::StrJoin(numbers, ",", [](std::string* out, double number) {
                     absl::StrAppend(out, client::ExactText(number));
                   })));
}

void AddGrid(const v1::Grid& grid, Words& words) {
  AddNumbers("--rho", grid.rho(), words);
  AddNumbers("--delta", grid.delta(), words);
  AddNumbers("--epsilon", grid.epsilon(), words);
  AddNumbers("--exponent", grid.exponent(), words);
  if (!grid.cells().empty()) {
    words.push_back(absl::StrCat("--cells=", absl::StrJoin(grid.cells(), ",")));
  }
  AddNumbers("--temperature", grid.temperature(), words);
  AddNumbers("--hot", grid.hot(), words);
  AddNumbers("--cold", grid.cold(), words);
}

void AddTarget(const v1::Target& target, Words& words) {
  if (target.has_samples()) words.push_back(absl::StrCat("--samples=", target.samples()));
  if (target.has_collisions()) words.push_back(absl::StrCat("--collisions=", target.collisions()));
  if (target.has_tolerance()) {
    words.push_back(absl::StrCat("--tolerance=", client::ExactText(target.tolerance())));
  }
  if (target.has_budget()) {
    words.push_back(absl::StrCat("--budget=", client::ExactText(BudgetSeconds(target))));
  }
  if (!target.estimate().empty()) words.push_back(absl::StrCat("--estimate=", target.estimate()));
}

Words WordsOf(const v1::EnsembleSpec& spec) {
  Words words = {"run", client::Spelling(spec.experiment())};
  AddGrid(spec.grid(), words);
  AddTarget(spec.target(), words);
  if (spec.seed() != 0) words.push_back(absl::StrCat("--seed=", spec.seed()));
  if (spec.model() != 0) words.push_back(absl::StrCat("--model=", client::Spelling(spec.model())));
  if (spec.precision() != 0) {
    words.push_back(absl::StrCat("--precision=", client::Spelling(spec.precision())));
  }
  if (spec.verify()) words.push_back("--verify");
  return words;
}

bool Ask(const Words& words, const v1::EnsembleSpec& spec) {
  const absl::StatusOr<client::CommandLine> line = client::ParseCommandLine(words);
  return line.ok() &&
         google::protobuf::util::MessageDifferencer::Equivalent(line->options.spec, spec);
}

}  // namespace

double BudgetSeconds(const v1::Target& target) {
  constexpr int64_t kNanos = 1'000'000'000;
  return static_cast<double>(target.budget().seconds() * kNanos + target.budget().nanos()) / kNanos;
}

std::string Command(const v1::EnsembleSpec& spec) {
  const Words words = WordsOf(spec);
  if (Ask(words, spec)) return absl::StrCat("ballpiston ", absl::StrJoin(words, " "));
  return absl::StrCat("ballpiston run --spec - <<<'", client::Json(spec), "'");
}

}  // namespace ballpiston::questions
