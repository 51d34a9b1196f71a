#include <google/protobuf/descriptor.h>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/strip.h"
#include "core/arithmetic/number_text.h"
#include "core/ensemble/experiment_kind.h"
#include "server/convert/spec.h"
#include "tests/questions/checks.h"
#include "tests/questions/question.h"

namespace ballpiston::questions {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using Texts = std::vector<std::string>;

// The texts of a list's values.
Texts TextsOfList(const Message& grid, const FieldDescriptor& list) {
  const google::protobuf::Reflection& reflection = *grid.GetReflection();
  Texts texts;
  for (int i = 0; i < reflection.FieldSize(grid, &list); ++i) {
    texts.push_back(list.type() == FieldDescriptor::TYPE_STRING
                        ? absl::CEscape(reflection.GetRepeatedString(grid, &list, i))
                        : NumberText(reflection.GetRepeatedDouble(grid, &list, i)));
  }
  return texts;
}

Texts TextsOfGrid(const v1::Grid& grid) {
  Texts texts;
  for (int i = 0; i < grid.GetDescriptor()->field_count(); ++i) {
    for (std::string& text : TextsOfList(grid, *grid.GetDescriptor()->field(i))) {
      texts.push_back(std::move(text));
    }
  }
  return texts;
}

// NAME[INDEX] or NAME.
Texts TextsOfGridField(const v1::Grid& grid, absl::string_view path) {
  const std::vector<std::string> parts = absl::StrSplit(path, absl::ByAnyChar("[]"));
  const FieldDescriptor* const list = grid.GetDescriptor()->FindFieldByName(parts[0]);
  if (list == nullptr) return {};
  const Texts texts = TextsOfList(grid, *list);
  size_t index = 0;
  if (parts.size() < 2 || !absl::SimpleAtoi(parts[1], &index)) {
    return {texts.empty()
                ? "is empty"
                : absl::StrCat("has ", texts.size(), texts.size() == 1 ? " value" : " values")};
  }
  return index < texts.size() ? Texts{texts[index]} : Texts();
}

Texts TextsOfTarget(const v1::Target& target, absl::string_view name) {
  constexpr char kDefault[] = "by default";
  if (name == "samples") return {absl::StrCat(target.samples()), kDefault};
  if (name == "collisions") return {absl::StrCat(target.collisions())};
  if (name == "tolerance") return {NumberText(target.tolerance())};
  if (name == "estimate") return {absl::CEscape(target.estimate())};
  if (name != "budget") return {};
  return {NumberText(BudgetSeconds(target)), "is set together"};
}

// How a description may show the value of the field; empty if there is no such field.
Texts TextsOf(const v1::EnsembleSpec& spec, absl::string_view field) {
  if (absl::ConsumePrefix(&field, "grid.")) return TextsOfGridField(spec.grid(), field);
  if (absl::ConsumePrefix(&field, "target.")) return TextsOfTarget(spec.target(), field);
  if (field == "grid") return {"points"};
  if (field == "experiment") return {absl::StrCat(int{spec.experiment()}), "is missing"};
  if (field == "model") {
    return {absl::StrCat(int{spec.model()}), std::string(Name(server::CheckSpec(spec).spec.model))};
  }
  if (field == "precision") return {absl::StrCat(int{spec.precision()}), "single"};
  if (field == "verify") return {"is set"};
  return {};
}

bool HasOneOf(absl::string_view description, const Texts& texts) {
  return std::any_of(texts.begin(), texts.end(),
                     [&](const std::string& text) { return absl::StrContains(description, text); });
}

// A tolerance may be impossible because of a value of the grid. The description then names that.
bool NamesAValueOfTheGrid(const v1::Grid& grid, absl::string_view description) {
  Texts texts;
  for (const std::string& text : TextsOfGrid(grid)) texts.push_back(absl::StrCat("= ", text));
  return HasOneOf(description, texts);
}

}  // namespace

Findings CheckRefusal(const v1::EnsembleSpec& spec, const std::vector<FieldViolation>& violations) {
  Findings findings;
  for (const auto& [path, description] : violations) {
    const auto add = [&](const char* what) {
      findings.push_back({kRefusalCheck, absl::StrCat(what, ": ", path, " ", description)});
    };
    absl::string_view field = path;
    const bool is_of_spec = absl::ConsumePrefix(&field, "spec.");
    const Texts texts = TextsOf(spec, field);
    if (!is_of_spec || texts.empty()) {
      add("names no field");
      continue;
    }
    if (!HasOneOf(description, texts) && !NamesAValueOfTheGrid(spec.grid(), description)) {
      add("does not show the value");
    }
    if (!HasOneOf(description, {"permitted", "needs", "does not use", "use ", "is it older"})) {
      add("does not say what is permitted");
    }
  }
  return findings;
}

}  // namespace ballpiston::questions
