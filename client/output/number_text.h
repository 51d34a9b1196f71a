// Numbers as text.
#ifndef BALLPISTON_CLIENT_OUTPUT_NUMBER_TEXT_H_
#define BALLPISTON_CLIENT_OUTPUT_NUMBER_TEXT_H_

#include <optional>
#include <string>

#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace ballpiston::client {

// The shortest text that reads back as the same double; whole numbers below 10^15 without exponent.
std::string ExactText(double value);

// A value to the digits its standard error supports: the error to two significant digits, the
// value and the exact value to the same decimal place. Without an error six significant digits.
//   (21.63214, 0.1234, 21.6225) -> 21.63, 0.12, 21.62
struct MeasuredText {
  std::string value;
  std::string error;  // empty if there is none
  std::string exact;  // empty if there is none
};
MeasuredText Measured(double value, std::optional<double> error,
                      std::optional<double> exact = std::nullopt);

// An error by itself, to the two significant digits that MeasuredText gives it: 0.0012, 1.2e-05, 0.
std::string TwoDigits(double error);

// A computing time with the unit that suits it, from ns to years, to two significant digits or
// three: 4.8 ns, 120 µs, 59 s, 3.2 min.
std::string DurationText(double seconds);

// 1 day, 3 days.
std::string Counted(double count, absl::string_view noun);

// 0:35, 12:04, 3:25:10; whole seconds, rounded up, so that it ends with 0:00 at the end only.
std::string ClockText(absl::Duration time);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_OUTPUT_NUMBER_TEXT_H_
