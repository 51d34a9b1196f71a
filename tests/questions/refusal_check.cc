#include <google/protobuf/descriptor.h>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/strip.h"
#include "core/arithmetic/number_text.h"
#include "core/ensemble/experiment_kind.h"
#include "server/convert/spec.h"
#include "tests/questions/checks.h"

namespace ballpiston::questions {
namespace {

using google::protobuf::FieldDescriptor;
using Texts = std::vector<std::string>;

constexpr size_t kLongestText = 100;  // a longer one is cut

// The texts of a list's values.
Texts TextsOfList(const v1::Grid& grid, const FieldDescriptor& list) {
  const google::protobuf::Reflection& reflection = *grid.GetReflection();
  Texts texts;
  for (int i = 0; i < reflection.FieldSize(grid, &list); ++i) {
    texts.push_back(
        list.type() == FieldDescriptor::TYPE_STRING
            ? absl::CEscape(reflection.GetRepeatedString(grid, &list, i).substr(0, kLongestText))
            : NumberText(reflection.GetRepeatedDouble(grid, &list, i)));
  }
  return texts;
}

// `path`: NAME[INDEX] or NAME.
Texts TextsOfGridField(const v1::Grid& grid, absl::string_view path) {
  const std::vector<std::string> parts = absl::StrSplit(path, absl::ByAnyChar("[]"));
  const FieldDescriptor* const list = grid.GetDescriptor()->FindFieldByName(parts[0]);
  if (list == nullptr) return {};
  const Texts texts = TextsOfList(grid, *list);
  size_t index = 0;
  if (parts.size() > 1 && absl::SimpleAtoi(parts[1], &index)) {
    return index < texts.size() ? Texts{texts[index]} : Texts();
  }
  return {texts.empty() ? "is empty" : absl::StrCat("has ", texts.size(), " value")};
}

// How a description may show the value of the field; empty if there is no such field.
Texts TextsOf(const v1::EnsembleSpec& spec, absl::string_view field) {
  if (absl::ConsumePrefix(&field, "grid.")) return TextsOfGridField(spec.grid(), field);
  const v1::Target& target = spec.target();
  const double budget =
      static_cast<double>(target.budget().seconds()) + target.budget().nanos() / 1e9;
  const std::map<absl::string_view, Texts> others = {
      {"grid", {"points"}},
      {"experiment", {absl::StrCat(int{spec.experiment()}), "is missing"}},
      {"model",
       {absl::StrCat(int{spec.model()}), std::string(Name(server::CheckSpec(spec).spec.model))}},
      {"precision", {absl::StrCat(int{spec.precision()}), "single"}},
      {"verify", {"is set"}},
      {"target.samples", {absl::StrCat(target.samples()), "by default"}},
      {"target.collisions", {absl::StrCat(target.collisions())}},
      {"target.tolerance", {NumberText(target.tolerance())}},
      {"target.estimate", {absl::CEscape(target.estimate().substr(0, kLongestText))}},
      {"target.budget", {NumberText(budget), "is set together"}},
      {"target.budget.nanos", {absl::StrCat(target.budget().nanos())}}};
  const auto found = others.find(field);
  return found == others.end() ? Texts() : found->second;
}

bool HasOneOf(absl::string_view description, const Texts& texts) {
  return std::any_of(texts.begin(), texts.end(),
                     [&](const std::string& text) { return absl::StrContains(description, text); });
}

// A tolerance may be impossible because of a value of the grid. The description then names that.
bool NamesAValueOfTheGrid(const v1::Grid& grid, absl::string_view description) {
  for (int i = 0; i < grid.GetDescriptor()->field_count(); ++i) {
    for (const std::string& text : TextsOfList(grid, *grid.GetDescriptor()->field(i))) {
      if (absl::StrContains(description, absl::StrCat("= ", text))) return true;
    }
  }
  return false;
}

}  // namespace

void CheckRefusal(const v1::EnsembleSpec& spec, const std::vector<FieldViolation>& violations) {
  for (const auto& [path, description] : violations) {
    absl::string_view field = path;
    const bool is_unknown = absl::StartsWith(description, "unknown field number");
    if (is_unknown && absl::StartsWith(field, "spec")) continue;  // of a newer client
    const Texts texts = absl::ConsumePrefix(&field, "spec.") ? TextsOf(spec, field) : Texts();
    const auto require = [&](bool is_so, const char* what) {
      Require(is_so, "refusal", what, ": ", path, " ", description);
    };
    require(!texts.empty(), "names no field");
    require(HasOneOf(description, texts) || NamesAValueOfTheGrid(spec.grid(), description),
            "does not show the value");
    require(HasOneOf(description, {"permitted", "needs", "does not use", "use ", "is it older"}),
            "does not say what is permitted");
  }
}

}  // namespace ballpiston::questions
