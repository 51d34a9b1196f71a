// Numbers as text.
#pragma once

#include <optional>
#include <string>

#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace ballpiston::client {

// The shortest text that reads back as the same double. Whole numbers below 10^15 have no exponent.
std::string ExactText(double value);

// A value with the digits that its standard error supports. The error has two significant digits;
// the value and the exact value end at the same decimal place. Without an error the value has six
// significant digits. With an error of 0, or of rounding only, it has twelve, and no error is
// shown.
//   (21.63214, 0.1234, 21.6225) -> 21.63, 0.12, 21.62
struct MeasuredText {
  std::string value;
  std::string error;  // empty if there is none
  std::string exact;  // empty if there is none
};
MeasuredText Measured(double value, std::optional<double> error,
                      std::optional<double> exact = std::nullopt);

// An error alone, with two significant digits as in MeasuredText: 0.0012, 1.2e-05, 0.
std::string TwoDigits(double error);

// A computing time in a suitable unit, from ns to years, with two or three significant digits:
// 4.8 ns, 120 µs, 59 s, 3.2 min.
std::string DurationText(double seconds);

// 1 day, 3 days.
std::string Counted(double count, absl::string_view noun);

// 0:35, 12:04, 3:25:10. Whole seconds, rounded up, so that 0:00 is shown only at the end.
std::string ClockText(absl::Duration time);

}  // namespace ballpiston::client
