#include "client/command/shape_list.h"

#include <cmath>
#include <cstdint>
#include <iterator>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "client/command/number_list.h"
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

// The numbers of a logarithmic range have rounding errors. A number counts as whole if its relative
// distance from a whole number is at most this.
constexpr double kRelativeRounding = 1e-12;
constexpr double kWholeUpTo = 0x1p53;
constexpr char kShapeForm[] = "is not a shape: write N, a chain of N cells, or NxM, a lattice";

absl::Status BadShapes(absl::string_view text, absl::string_view reason) {
  return absl::InvalidArgumentError(absl::StrCat(Quoted(text), " ", reason));
}

absl::StatusOr<std::vector<std::string>> ParseChains(absl::string_view text) {
  const absl::StatusOr<std::vector<double>> numbers = ParseNumberList(text);
  if (!numbers.ok()) return numbers.status();
  std::vector<std::string> chains;
  for (const double number : *numbers) {
    const double whole = std::round(number);
    const double rounding = std::abs(number - whole);
    if (rounding > kRelativeRounding * std::abs(number) || std::abs(whole) > kWholeUpTo) {
      return BadShapes(text, "has numbers that are not whole");
    }
    chains.push_back(absl::StrCat(static_cast<int64_t>(whole)));
  }
  return chains;
}

absl::StatusOr<std::vector<std::string>> ParseShapes(absl::string_view item) {
  if (item.find(':') != absl::string_view::npos) return ParseChains(item);
  const absl::StatusOr<std::string> shape = ParseShape(item);
  if (!shape.ok()) return shape.status();
  return std::vector<std::string>{*shape};
}

}  // namespace

absl::StatusOr<std::string> ParseShape(absl::string_view text) {
  const std::vector<absl::string_view> parts = absl::StrSplit(text, absl::MaxSplits('x', 1));
  std::vector<int64_t> counts;
  for (const absl::string_view part : parts) {
    const absl::StatusOr<int64_t> count = ParseCount(part);
    if (!count.ok()) return BadShapes(text, kShapeForm);
    counts.push_back(*count);
  }
  return absl::StrJoin(counts, "x");
}

absl::StatusOr<std::vector<std::string>> ParseShapeList(absl::string_view text) {
  std::vector<std::string> list;
  for (const absl::string_view item : absl::StrSplit(text, ',')) {
    const auto shapes = ParseShapes(item);
    if (!shapes.ok()) return shapes.status();
    if (std::ssize(list) + std::ssize(*shapes) > kMaxListLength) {
      return BadShapes(text, absl::StrCat("has more than ", kMaxListLength, " shapes"));
    }
    list.insert(list.end(), shapes->begin(), shapes->end());
  }
  return list;
}

}  // namespace ballpiston::client
