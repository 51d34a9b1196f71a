#include "client/output/number_text.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

TEST(ExactText, ReadsBackAsTheSameDouble) {
  for (const double x : {0.1, 1.0 / 3, 0.529561127988977, 1e-300, 5e-324, 1.7976931348623157e308,
                         -2.5e-7, 123456789.125, std::nextafter(1.0, 2.0)}) {
    EXPECT_EQ(std::strtod(ExactText(x).c_str(), nullptr), x) << ExactText(x);
  }
}

TEST(ExactText, WholeNumbersHaveNoExponent) {
  EXPECT_EQ(ExactText(0), "0");
  EXPECT_EQ(ExactText(1'000'000), "1000000");
  EXPECT_EQ(ExactText(-42), "-42");
  EXPECT_EQ(ExactText(1e12), "1000000000000");
}

void ExpectMeasured(double value, double error, const std::string& value_text,
                    const std::string& error_text) {
  const MeasuredText text = Measured(value, error);
  EXPECT_EQ(text.value, value_text);
  EXPECT_EQ(text.error, error_text);
}

TEST(Measured, AnExactValueHasTwelveDigitsAndNoError) {
  ExpectMeasured(52.65625940298963, 2.6e-13, "52.656259403", "");
  ExpectMeasured(1234.5678901234, 1e-10, "1234.56789012", "");
  ExpectMeasured(1.0 / 3, 0, "0.333333333333", "");
  ExpectMeasured(0, 0, "0", "0");
  EXPECT_EQ(Measured(0.3102289521723049, 1.6e-15, 0.3102289521723049).exact, "0.310228952172");
}

TEST(Measured, HasTheDigitsThatTheErrorSupports) {
  ExpectMeasured(21.63214, 0.1234, "21.63", "0.12");
  ExpectMeasured(21.63214, 0.01234, "21.632", "0.012");
  ExpectMeasured(0.0012345678, 0.0000045, "0.0012346", "0.0000045");
  ExpectMeasured(1234.5678, 12.3, "1235", "12");
  ExpectMeasured(1234.5678, 456, "1235", "456");
  ExpectMeasured(-0.5, 0.25, "-0.50", "0.25");
  ExpectMeasured(0, 0.25, "0.00", "0.25");
}

TEST(Measured, VeryLargeAndVerySmallNumbersHaveExponents) {
  ExpectMeasured(1.23456e-8, 4.5e-11, "1.2346e-08", "4.5e-11");
  ExpectMeasured(6.54321e9, 1.2e6, "6.5432e+09", "1.2e+06");
}

TEST(Measured, TheExactValueHasTheSameDigits) {
  EXPECT_EQ(Measured(21.63214, 0.1234, 21.62257).exact, "21.62");
  EXPECT_EQ(Measured(21.63214, 0.1234).exact, "");
}

// The limit can be infinite if the estimate is small.
TEST(Measured, AnInfiniteExactValueHasNoDigits) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Measured(1e-8, 1e-12, infinity).exact, "inf");
  EXPECT_EQ(Measured(1e-8, 1e-12, -infinity).exact, "-inf");
  EXPECT_EQ(Measured(1e-8, 1e-12, std::nan("")).exact, "nan");
  EXPECT_EQ(Measured(0.5, 0.25, infinity).exact, "inf");
}

TEST(Measured, HasSixDigitsWithoutAnError) {
  EXPECT_EQ(Measured(1.0 / 3, std::nullopt).value, "0.333333");
  EXPECT_EQ(Measured(1.0 / 3, std::nullopt).error, "");
}

TEST(TwoDigits, RoundsAsTheErrorOfAMeasuredValue) {
  EXPECT_EQ(TwoDigits(0.1234), "0.12");
  EXPECT_EQ(TwoDigits(123.4), "123");
  EXPECT_EQ(TwoDigits(1.234e-5), "1.2e-05");
  EXPECT_EQ(TwoDigits(0), "0");
}

TEST(DurationText, HasASuitableUnit) {
  EXPECT_EQ(DurationText(0), "0 s");
  EXPECT_EQ(DurationText(1e-10), "0.1 ns");
  EXPECT_EQ(DurationText(4.84e-9), "4.8 ns");
  EXPECT_EQ(DurationText(12.3e-6), "12 µs");
  EXPECT_EQ(DurationText(0.123), "123 ms");
  EXPECT_EQ(DurationText(1.5), "1.5 s");
  EXPECT_EQ(DurationText(192), "3.2 min");
  EXPECT_EQ(DurationText(9000), "2.5 h");
  EXPECT_EQ(DurationText(1e6), "12 d");
  EXPECT_EQ(DurationText(1e9), "32 y");
}

// Never 1000 µs, and as many digits as neighbouring durations.
TEST(DurationText, RoundsUpIntoTheNextUnit) {
  EXPECT_EQ(DurationText(999.4e-6), "999 µs");
  EXPECT_EQ(DurationText(999.6e-6), "1.0 ms");
  EXPECT_EQ(DurationText(9.94), "9.9 s");
  EXPECT_EQ(DurationText(9.96), "10 s");
}

TEST(ClockText, CountsMinutesThenHours) {
  EXPECT_EQ(ClockText(absl::ZeroDuration()), "0:00");
  EXPECT_EQ(ClockText(absl::Milliseconds(34200)), "0:35");
  EXPECT_EQ(ClockText(absl::Seconds(724)), "12:04");
  EXPECT_EQ(ClockText(absl::Seconds(12310)), "3:25:10");
}

TEST(Counted, OneIsSingular) {
  EXPECT_EQ(Counted(1, "day"), "1 day");
  EXPECT_EQ(Counted(0, "job"), "0 jobs");
  EXPECT_EQ(Counted(2.5, "day"), "2.5 days");
}

}  // namespace
}  // namespace ballpiston::client
