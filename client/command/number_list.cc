#include "client/command/number_list.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <system_error>

#include "absl/status/status.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "client/command/violations.h"
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

absl::Status Bad(absl::string_view flag, absl::string_view text, absl::string_view reason) {
  return absl::InvalidArgumentError(absl::StrCat(flag, ": ", Quoted(text), " ", reason));
}

// std::from_chars takes no blanks, no plus sign and no hexadecimal, but it takes nan and inf:
// those have letters other than e.
std::optional<double> Number(absl::string_view text) {
  if (text.find_first_not_of("0123456789+-.eE") != absl::string_view::npos) return std::nullopt;
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

std::optional<int64_t> Count(absl::string_view text) {
  constexpr double kExactBelow = 9007199254740992;  // 2^53
  int64_t count = 0;
  if (text.find_first_of(" +") == absl::string_view::npos && absl::SimpleAtoi(text, &count)) {
    return count;
  }
  const std::optional<double> value = Number(text);
  if (!value || *value != std::floor(*value) || std::abs(*value) > kExactBelow) return std::nullopt;
  return static_cast<int64_t>(*value);
}

struct Range {
  double from = 0;
  double to = 0;
  int64_t count = 1;
  bool logarithmic = false;

  // Weights that add up to exactly count - 1 give decimal fractions their nearest double.
  double At(int64_t i) const {
    const auto steps = static_cast<double>(count - 1);
    const auto step = static_cast<double>(i);
    if (i == 0) return from;
    if (i == count - 1) return to;
    if (logarithmic) return from * std::pow(to / from, step / steps);
    return ((steps - step) * from + step * to) / steps;
  }
};

constexpr double kLargest = 1e100;
constexpr char kRangeForm[] = "is not a range: write FROM:TO:COUNT or FROM:TO:COUNT:log";

absl::StatusOr<Range> ParseRange(absl::string_view flag, absl::string_view text) {
  const std::vector<absl::string_view> parts = absl::StrSplit(text, ':');
  if (parts.size() < 3 || parts.size() > 4) return Bad(flag, text, kRangeForm);
  if (parts.size() == 4 && parts[3] != "log") return Bad(flag, text, kRangeForm);
  const auto from = Number(parts[0]);
  const auto to = Number(parts[1]);
  const auto count = Count(parts[2]);
  if (!from || !to) return Bad(flag, text, "has an end that is not a decimal number");
  if (!count || *count < 1 || *count > kMaxListLength) {
    return Bad(flag, text,
               absl::StrCat("has a count that is not a whole number from 1 to ", kMaxListLength));
  }
  const bool logarithmic = parts.size() == 4;
  if (logarithmic && (*from <= 0 || *to <= 0)) {
    return Bad(flag, text, "is logarithmic, so both ends have to be above 0");
  }
  // Multiplied by the count, and as a ratio, the ends have to stay finite.
  if (std::abs(*from) > kLargest || std::abs(*to) > kLargest) {
    return Bad(flag, text, "has an end beyond 1e100");
  }
  return Range{*from, *to, *count, logarithmic};
}

// A number is a range of one.
absl::StatusOr<Range> ParseItem(absl::string_view flag, absl::string_view item) {
  if (item.find(':') != absl::string_view::npos) return ParseRange(flag, item);
  const absl::StatusOr<double> number = ParseNumber(flag, item);
  if (!number.ok()) return number.status();
  return Range{*number, *number, 1, false};
}

absl::Status TooLong(absl::string_view flag, absl::string_view text, int64_t length) {
  constexpr size_t kShown = 40;
  const absl::string_view dots = text.size() > kShown ? "..." : "";
  return Bad(flag, absl::StrCat(text.substr(0, kShown), dots),
             absl::StrCat("has ", length, " numbers; at most ", kMaxListLength, " are permitted"));
}

}  // namespace

absl::StatusOr<double> ParseNumber(absl::string_view flag, absl::string_view text) {
  if (const auto number = Number(text)) return *number;
  return Bad(flag, text, "is not a decimal number such as 0.1 or 1e-3");
}

absl::StatusOr<int64_t> ParseCount(absl::string_view flag, absl::string_view text) {
  if (const auto count = Count(text)) return *count;
  return Bad(flag, text, "is not a whole number such as 10000 or 1e6");
}

absl::StatusOr<uint64_t> ParseSeed(absl::string_view flag, absl::string_view text) {
  uint64_t seed = 0;
  const bool digits = text.find_first_not_of("0123456789") == absl::string_view::npos;
  if (digits && absl::SimpleAtoi(text, &seed)) return seed;
  return Bad(flag, text, "is not a whole number from 0 to 18446744073709551615");
}

absl::StatusOr<std::vector<double>> ParseNumberList(absl::string_view flag,
                                                    absl::string_view text) {
  std::vector<double> list;
  Violations violations;
  int64_t length = 0;  // goes on where the list has become too long to be made
  for (const absl::string_view item : absl::StrSplit(text, ',')) {
    const absl::StatusOr<Range> range = ParseItem(flag, item);
    violations.Add(range.status());
    length += range.ok() ? range->count : 1;
    if (!range.ok() || length > kMaxListLength) continue;
    for (int64_t i = 0; i < range->count; ++i) list.push_back(range->At(i));
  }
  if (length > kMaxListLength) violations.Add(TooLong(flag, text, length));
  if (absl::Status status = violations.Lines(); !status.ok()) return status;
  return list;
}

absl::StatusOr<std::vector<int32_t>> ParseCountList(absl::string_view flag,
                                                    absl::string_view text) {
  absl::StatusOr<std::vector<double>> numbers = ParseNumberList(flag, text);
  if (!numbers.ok()) return numbers.status();
  std::vector<int32_t> list;
  for (const double number : *numbers) {
    if (number != std::floor(number) || std::abs(number) > std::numeric_limits<int32_t>::max()) {
      return Bad(flag, text, "has a number that is not whole");
    }
    list.push_back(static_cast<int32_t>(number));
  }
  return list;
}

}  // namespace ballpiston::client
