#include "server/command_line/flag_values.h"

#include <cmath>

#include "absl/strings/numbers.h"
#include "absl/strings/str_format.h"

namespace ballpiston::server {
namespace {

bool Read(const std::string& text, double& number) { return absl::SimpleAtod(text, &number); }

// Accepts 1e6, but not nan, and nothing beyond 2^53, where a double is not exact.
bool Read(const std::string& text, int64_t& number) {
  if (absl::SimpleAtoi(text, &number)) return true;
  double real = 0;
  if (!absl::SimpleAtod(text, &real) || !(std::fabs(real) <= 0x1p53)) return false;
  number = static_cast<int64_t>(real);
  return static_cast<double>(number) == real;
}

// Why the text is refused.
template <typename Number>
std::string Fault(const std::string& text, const Range<Number>& range) {
  double number = 0;
  if (!Read(text, number) || std::isnan(number)) return "is not a number";
  const bool in_range =
      number >= static_cast<double>(range.least) && number <= static_cast<double>(range.most);
  return in_range && std::floor(number) != number ? "is not a whole number" : "is out of range";
}

// Not parsed by CLI11, which reads 010 as 8, an empty text as 0, and 1e30 as the greatest integer.
template <typename Number>
Number NumberWithin(const std::string& flag, const std::string& text, const Range<Number>& range) {
  Number number{};
  if (Read(text, number) && number >= range.least && number <= range.most) return number;
  Refuse(flag, text, Fault(text, range), range.text);
}

}  // namespace

void Refuse(const std::string& flag, const std::string& value, const std::string& why,
            const std::string& permitted) {
  throw CLI::ValidationError(
      absl::StrCat("--", flag, "=", value, " ", why, "; permitted: ", permitted));
}

std::string NumberText(double number) { return absl::StrFormat("%.15g", number); }
std::string NumberText(int64_t number) { return absl::StrCat(number); }

double NumberOf(const std::string& flag, const std::string& text, const Range<double>& range) {
  return NumberWithin(flag, text, range);
}
int64_t NumberOf(const std::string& flag, const std::string& text, const Range<int64_t>& range) {
  return NumberWithin(flag, text, range);
}

void AddSeconds(CLI::App& app, const std::string& flag, std::chrono::milliseconds& time,
                const Range<double>& range, const std::string& description) {
  const auto set = [&time, flag, range](const std::string& text) {
    const double seconds = NumberOf(flag, text, range);
    time = std::chrono::milliseconds(static_cast<int64_t>(std::ceil(1000 * seconds)));
  };
  app.add_option_function<std::string>("--" + flag, set,
                                       absl::StrCat(description, "; ", range.text))
      ->type_name("SECONDS")
      ->default_str(NumberText(std::chrono::duration<double>(time).count()));
}

}  // namespace ballpiston::server
