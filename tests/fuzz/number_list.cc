// The client's numbers, counts, seeds, lists of numbers and lists of shapes.
#include "client/command/number_list.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/match.h"
#include "client/command/shape_list.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

void RequireTold(const absl::Status& error) {
  Require(absl::IsInvalidArgument(error), "what is wrong is the argument");
  Require(absl::StartsWith(error.message(), "'"), "the text is quoted");
}

// Whether the text has a range with a count of hundreds or with an exponent. Such lists take longer
// than all other inputs together, and differ only in their length.
bool IsLong(const std::string& text) {
  constexpr size_t kLong = 3;
  if (text.find(':') == std::string::npos) return false;
  size_t digits = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool exponent = (text[i] | 0x20) == 'e' && text.compare(i + 1, 1, "-") != 0;
    digits = exponent ? kLong : text[i] >= '0' && text[i] <= '9' ? digits + 1 : 0;
    if (digits >= kLong) return true;
  }
  return false;
}

void CheckList(const std::string& text) {
  const auto list = client::ParseNumberList(text);
  if (!list.ok()) return RequireTold(list.status());
  Require(!list->empty() && list->size() <= client::kMaxListLength, "a list has a length");
  Require(std::all_of(list->begin(), list->end(), [](double x) { return std::isfinite(x); }),
          "a number is finite");
}

void CheckShapes(const std::string& text) {
  const auto list = client::ParseShapeList(text);
  if (!list.ok()) return RequireTold(list.status());
  Require(!list->empty() && list->size() <= client::kMaxListLength, "a list has a length");
  for (const std::string& shape : *list) {
    const auto again = client::ParseShapeList(shape);
    Require(again.ok() && *again == std::vector<std::string>{shape}, "a shape has one spelling");
  }
}

void CheckNumberList(const std::string& text) {
  const auto number = client::ParseNumber(text);
  const auto count = client::ParseCount(text);
  const auto seed = client::ParseSeed(text);
  if (!number.ok()) RequireTold(number.status());
  if (!count.ok()) RequireTold(count.status());
  if (!seed.ok()) RequireTold(seed.status());
  Require(!number.ok() || std::isfinite(*number), "a number is finite");
  if (IsLong(text) && !IsOneIn(256, text)) return;
  CheckList(text);
  CheckShapes(text);
}

const Registration kNumberList({.name = "number_list", .check = CheckNumberList});

}  // namespace
}  // namespace ballpiston::fuzz
