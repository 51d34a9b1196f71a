#include "tests/questions/question.h"

#include "client/output/json.h"

namespace ballpiston::questions {

double BudgetSeconds(const v1::Target& target) {
  constexpr int64_t kNanos = 1'000'000'000;
  return static_cast<double>(target.budget().seconds() * kNanos + target.budget().nanos()) / kNanos;
}

std::string Command(const v1::EnsembleSpec& spec) {
  return absl::StrCat("ballpiston run --spec - <<<'", client::Json(spec), "'");
}

}  // namespace ballpiston::questions
