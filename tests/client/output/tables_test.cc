// The texts of numbers, and the plan of eight points. transcripts/ shows the rest.
#include "client/output/answers.h"
#include "client/output/number_text.h"
#include "client/output/table.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// ---- number_text.h ----

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

TEST(TenDigits, AreAllIfTheyWouldSeemToBeTheNeighbour) {
  EXPECT_EQ(TenDigits(0.4999999999999999), "0.4999999999999999");
  EXPECT_EQ(TenDigits(0.5000000000000001), "0.5000000000000001");
  EXPECT_EQ(TenDigits(0.50000000001), "0.50000000001");
  EXPECT_EQ(TenDigits(0.70710678118), "0.70710678118");
  EXPECT_EQ(TenDigits(0.5), "0.5");
  EXPECT_EQ(TenDigits(0.1), "0.1");
  EXPECT_EQ(TenDigits(1.0 / 3), "0.3333333333");
}

TEST(Measured, HasTheDigitsThatTheErrorSupports) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const struct {
    double value;
    std::optional<double> error, exact;
    std::string value_text, error_text, exact_text;
  } cases[] = {{21.63214, 0.1234, 21.62257, "21.63", "0.12", "21.62"},
               {21.63214, 0.01234, {}, "21.632", "0.012", ""},
               {0.0012345678, 0.0000045, {}, "0.0012346", "0.0000045", ""},
               {1234.5678, 12.3, {}, "1235", "12", ""},
               {1234.5678, 456, {}, "1235", "456", ""},
               {-0.5, 0.25, kInfinity, "-0.50", "0.25", "inf"},
               {0, 0.25, {}, "0.00", "0.25", ""},
               // Very large and very small numbers have exponents. The limit of a small value may
               // be infinite.
               {1.23456e-8, 4.5e-11, kInfinity, "1.2346e-08", "4.5e-11", "inf"},
               {1.23456e-8, 4.5e-11, -kInfinity, "1.2346e-08", "4.5e-11", "-inf"},
               {1.23456e-8, 4.5e-11, NAN, "1.2346e-08", "4.5e-11", "nan"},
               {6.54321e9, 1.2e6, {}, "6.5432e+09", "1.2e+06", ""},
               // An exact value has twelve digits and no error; without an error there are six.
               {0.3102289521723, 1.6e-15, 0.3102289521723, "0.310228952172", "", "0.310228952172"},
               {52.65625940298963, 2.6e-13, {}, "52.656259403", "", ""},
               {1234.5678901234, 1e-10, {}, "1234.56789012", "", ""},
               {1.0 / 3, 0, {}, "0.333333333333", "", ""},
               {0, 0, {}, "0", "0", ""},
               {1.0 / 3, {}, {}, "0.333333", "", ""}};
  for (const auto& [value, error, exact, value_text, error_text, exact_text] : cases) {
    const MeasuredText text = Measured(value, error, exact);
    EXPECT_EQ(text.value, value_text);
    EXPECT_EQ(text.error, error_text) << value_text;
    EXPECT_EQ(text.exact, exact_text) << value_text;
  }
}

// Never 1000 µs, and as many digits as neighbouring durations.
TEST(DurationText, HasASuitableUnit) {
  const std::pair<double, const char*> cases[] = {
      {0, "0 s"},           {1e-10, "0.1 ns"},    {4.84e-9, "4.8 ns"}, {12.3e-6, "12 µs"},
      {999.4e-6, "999 µs"}, {999.6e-6, "1.0 ms"}, {0.123, "123 ms"},   {1.5, "1.5 s"},
      {9.94, "9.9 s"},      {9.96, "10 s"},       {192, "3.2 min"},    {9000, "2.5 h"},
      {1e6, "12 d"},        {1e9, "32 y"}};
  for (const auto& [seconds, text] : cases) EXPECT_EQ(DurationText(seconds), text);
}

TEST(ClockText, CountsMinutesThenHours) {
  EXPECT_EQ(ClockText(absl::ZeroDuration()), "0:00");
  EXPECT_EQ(ClockText(absl::Milliseconds(34200)), "0:35");
  EXPECT_EQ(ClockText(absl::Seconds(724)), "12:04");
  EXPECT_EQ(ClockText(absl::Seconds(12310)), "3:25:10");
}

// ---- answers.h ----

// transcripts/plan.txt shows nine points, which have a row each.
TEST(PlanTable, HasLaddersUpToEightPoints) {
  v1::PlanEnsembleJobResponse plan;
  for (int i = 0; i < 8; ++i) plan.add_points();
  std::ostringstream out;
  PrintPlan(v1::EnsembleSpec(), plan, Format::kTable, out);
  EXPECT_THAT(out.str(), HasSubstr("answers"));
}

}  // namespace
}  // namespace ballpiston::client
