#include "client/command/number_list.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>

#include "absl/status/status.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "client/library/quoted.h"

namespace ballpiston::client {
namespace {

// std::from_chars rejects blanks, a plus sign and hexadecimal numbers, but accepts nan and inf.
// Therefore no letters other than e are permitted here.
std::errc ReadNumber(absl::string_view text, double& value) {
  if (text.find_first_not_of("0123456789+-.eE") != text.npos) return std::errc::invalid_argument;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return stop == end ? error : std::errc::invalid_argument;
}

std::optional<double> ToNumber(absl::string_view text) {
  double value = 0;
  return ReadNumber(text, value) == std::errc() ? std::optional(value) : std::nullopt;
}

constexpr double kExactBelow = 9007199254740992;  // 2^53
constexpr double kCountBelow = 0x1p63;

bool IsWhole(const std::optional<double>& value) { return value && *value == std::floor(*value); }

std::optional<int64_t> ToCount(absl::string_view text) {
  int64_t count = 0;
  if (text.find_first_of(" +") == absl::string_view::npos && absl::SimpleAtoi(text, &count)) {
    return count;
  }
  const std::optional<double> value = ToNumber(text);
  if (!IsWhole(value) || std::abs(*value) >= kCountBelow) return std::nullopt;
  return static_cast<int64_t>(*value);
}

struct Range {
  double from, to;
  int64_t count;
  bool logarithmic;

  // Rounds to 15 digits, so that 0.01:0.49:49 gives the doubles nearest to its decimal fractions. A
  // logarithmic range has 12, because C libraries differ in the last bits of a power, and another
  // bit would be another question.
  double At(int64_t i) const {
    const auto steps = static_cast<double>(count - 1);
    const auto step = static_cast<double>(i);
    if (i == 0) return from;
    if (i == count - 1) return to;
    // The ratio of the ends may be beyond the range of a double.
    const double share = step / steps;
    return *ToNumber(logarithmic
                         ? absl::StrFormat("%.12g", std::pow(from, 1 - share) * std::pow(to, share))
                         : absl::StrFormat("%.15g", ((steps - step) * from + step * to) / steps));
  }
};

constexpr double kLargest = 1e150;
constexpr char kRangeForm[] = "is not a range: write FROM:TO:COUNT or FROM:TO:COUNT:log";

absl::StatusOr<Range> ParseRange(absl::string_view text) {
  const std::vector<absl::string_view> parts = absl::StrSplit(text, ':');
  if (parts.size() < 3 || parts.size() > 4) return NotPermitted(text, kRangeForm);
  if (parts.size() == 4 && parts[3] != "log") return NotPermitted(text, kRangeForm);
  const auto from = ToNumber(parts[0]);
  const auto to = ToNumber(parts[1]);
  const auto count = ToCount(parts[2]);
  if (!from || !to) return NotPermitted(text, "has an end that is not a decimal number");
  if (!count || *count < 1 || *count > kMaxListLength) {
    return NotPermitted(
        text, absl::StrCat("has a count that is not a whole number from 1 to ", kMaxListLength));
  }
  if (*count == 1 && *from != *to) {
    return NotPermitted(
        text,
        "has two different ends and a count of 1; permitted: a count of at least 2, or equal ends");
  }
  const bool logarithmic = parts.size() == 4;
  if (logarithmic && (*from <= 0 || *to <= 0)) {
    return NotPermitted(text, "is logarithmic: both ends must be above 0");
  }
  // The ends times the count must stay finite.
  if (std::abs(*from) > kLargest || std::abs(*to) > kLargest) {
    return NotPermitted(text, "has an end beyond 1e150");
  }
  return Range{*from, *to, *count, logarithmic};
}

std::string ChainText(double number) {
  return IsWhole(number) && std::abs(number) < kExactBelow
             ? absl::StrCat(static_cast<int64_t>(number))
             : absl::StrFormat("%.17g", number);
}

// `parse` reads an item that is not a range, and `from` makes an item of a range's number.
template <typename Item, typename Parse, typename From>
absl::StatusOr<std::vector<Item>> ParseList(absl::string_view text, const char* items, Parse parse,
                                            From from) {
  std::vector<Item> list;
  for (const absl::string_view part : absl::StrSplit(text, ',')) {
    if (part.find(':') == absl::string_view::npos) {
      const absl::StatusOr<Item> item = parse(part);
      if (!item.ok()) return item.status();
      list.push_back(*item);
    } else {
      const absl::StatusOr<Range> range = ParseRange(part);
      if (!range.ok()) return range.status();
      for (int64_t i = 0; i < range->count; ++i) list.push_back(from(range->At(i)));
    }
    if (std::ssize(list) > kMaxListLength) {
      return NotPermitted(text, absl::StrCat("has more than ", kMaxListLength, " ", items));
    }
  }
  return list;
}

}  // namespace

absl::Status NotPermitted(absl::string_view text, absl::string_view reason) {
  return absl::InvalidArgumentError(absl::StrCat(Quoted(text), " ", reason));
}

absl::StatusOr<double> ParseNumber(absl::string_view text) {
  double value = 0;
  const std::errc error = ReadNumber(text, value);
  if (error == std::errc()) return value;
  return NotPermitted(
      text,
      error == std::errc::result_out_of_range
          ? "is beyond double precision; permitted: 0, or an absolute value from 5e-324 to 1.79e308"
          : "is not a decimal number such as 0.1 or 1e-3");
}

absl::StatusOr<int64_t> ParseCount(absl::string_view text) {
  if (const auto count = ToCount(text)) return *count;
  if (IsWhole(ToNumber(text))) {
    return NotPermitted(text, "is out of range; permitted: at most 9223372036854775807 in size");
  }
  return NotPermitted(text, "is not a whole number such as 10000 or 1e6");
}

absl::StatusOr<uint64_t> ParseSeed(absl::string_view text) {
  uint64_t seed = 0;
  const bool digits = text.find_first_not_of("0123456789") == absl::string_view::npos;
  if (digits && absl::SimpleAtoi(text, &seed)) return seed;
  return NotPermitted(text, "is not a whole number from 0 to 18446744073709551615");
}

absl::StatusOr<std::vector<double>> ParseNumberList(absl::string_view text) {
  return ParseList<double>(text, "numbers", ParseNumber, [](double x) { return x; });
}

std::string ShapeText(absl::string_view text) {
  const auto count = ToCount(text);
  return count ? absl::StrCat(*count) : std::string(text);
}

absl::StatusOr<std::vector<std::string>> ParseShapeList(absl::string_view text) {
  const auto shape = [](absl::string_view part) {
    return absl::StatusOr<std::string>(ShapeText(part));
  };
  return ParseList<std::string>(text, "shapes", shape, ChainText);
}

}  // namespace ballpiston::client
