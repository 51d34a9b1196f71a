#include "client/output/number_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace ballpiston::client {
namespace {

constexpr double kWholeBelow = 1e15;

// A number outside these limits is written with an exponent.
constexpr double kSmallest = 1e-4;
constexpr double kLargest = 1e7;

// The exponent before rounding. Rounding may carry (0.0996 -> 0.100): then the text has one digit
// more than needed, which does no harm.
int DecimalExponent(double x) { return static_cast<int>(std::floor(std::log10(std::abs(x)))); }

// An error below this part of the value is that of rounding: the value is exact.
constexpr double kRounding = 5e-13;
constexpr int kDigitsOfExact = 12;
constexpr int kDigitsWithoutError = 6;

std::string Significant(double x, int digits = kDigitsWithoutError) {
  return absl::StrFormat("%.*g", digits, x);
}

std::string Fixed(double x, int decimals) { return absl::StrFormat("%.*f", decimals, x); }

std::string Scientific(double x, int last_digit) {
  if (x == 0) return "0";
  if (!std::isfinite(x)) return Significant(x);  // it has no exponent
  return absl::StrFormat("%.*e", std::max(0, DecimalExponent(x) - last_digit), x);
}

// `last_digit` is the power of ten of the last printed digit.
std::string RoundedAt(double x, int last_digit, bool scientific) {
  return scientific ? Scientific(x, last_digit) : Fixed(x, std::max(0, -last_digit));
}

}  // namespace

std::string ExactText(double value) {
  if (value == std::floor(value) && std::abs(value) < kWholeBelow) {
    return absl::StrFormat("%.0f", value);
  }
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof(buffer), value).ptr;
  return std::string(buffer, end);
}

MeasuredText Measured(double value, std::optional<double> error, std::optional<double> exact) {
  MeasuredText text;
  const bool is_exact = error && *error >= 0 && *error < kRounding * std::abs(value);
  const bool has_scatter = error && *error > 0 && std::isfinite(*error) && std::isfinite(value);
  if (is_exact || !has_scatter) {
    const int digits = is_exact ? kDigitsOfExact : kDigitsWithoutError;
    text.value = Significant(value, digits);
    if (error && !is_exact) text.error = Significant(*error);
    if (exact) text.exact = Significant(*exact, digits);
    return text;
  }
  const int last_digit = DecimalExponent(*error) - 1;
  const double size = std::max(std::abs(value), *error);
  const bool scientific = size < kSmallest || size >= kLargest;
  text.value = RoundedAt(value, last_digit, scientific);
  text.error = RoundedAt(*error, last_digit, scientific);
  if (exact) text.exact = RoundedAt(*exact, last_digit, scientific);
  return text;
}

std::string TwoDigits(double error) { return Measured(error, error).error; }

std::string DurationText(double seconds) {
  struct Unit {
    double seconds;
    const char* name;
  };
  constexpr Unit kUnits[] = {{1e-9, "ns"}, {1e-6, "µs"}, {1e-3, "ms"}, {1, "s"},
                             {60, "min"},  {3600, "h"},  {86400, "d"}, {31557600, "y"}};
  if (seconds == 0) return "0 s";
  const Unit* unit = kUnits;
  for (const Unit& next : kUnits) {
    if (seconds >= 0.9995 * next.seconds) unit = &next;  // 999.6 µs is 1.0 ms
  }
  const double count = seconds / unit->seconds;
  return absl::StrFormat("%.*f %s", count < 9.95 ? 1 : 0, count, unit->name);
}

std::string Counted(double count, absl::string_view noun) {
  return absl::StrCat(ExactText(count), " ", noun, count == 1 ? "" : "s");
}

std::string ClockText(absl::Duration time) {
  const int64_t seconds = absl::ToInt64Seconds(absl::Ceil(time, absl::Seconds(1)));
  const int64_t minutes = seconds / 60;
  if (minutes < 60) return absl::StrFormat("%d:%02d", minutes, seconds % 60);
  return absl::StrFormat("%d:%02d:%02d", minutes / 60, minutes % 60, seconds % 60);
}

}  // namespace ballpiston::client
