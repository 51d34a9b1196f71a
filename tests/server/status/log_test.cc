#include "server/status/log.h"

#include "gmock/gmock.h"

namespace ballpiston::server {
namespace {

// tests/fuzz (log_line) tests that any text gives one line of printable characters.
TEST(LogLine, IsAMessageForPeople) {
  EXPECT_EQ(LogLine(Severity::kWarning, "the server's \"disk\"",
                    {{"job", "ensembleJobs/1"},
                     {"who", "a \"b\""},
                     {"empty", ""},
                     {"n", 3},
                     {"seconds", 0.25}}),
            "ballpistond: warning: the server's \"disk\" "
            "(job=ensembleJobs/1 who=\"a \\\"b\\\"\" n=3 seconds=0.25)\n");
  EXPECT_EQ(LogLine(Severity::kInfo, "stopping"), "ballpistond: stopping\n");
  EXPECT_EQ(LogLine(Severity::kError, "a\n\xC3\xA9"), "ballpistond: error: a\\n\\xc3\\xa9\n");
}

TEST(Log, LinesHaveATimeAndAtLeastTheChosenSeverity) {
  SetLogLevel(Severity::kWarning);
  testing::internal::CaptureStderr();
  Log(Severity::kInfo, "a");
  Log(Severity::kWarning, "b");
  SetLogLevel(Severity::kNone);
  Log(Severity::kError, "c");
  SetLogLevel(Severity::kInfo);
  EXPECT_THAT(
      testing::internal::GetCapturedStderr(),
      testing::MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}\\.[0-9]{3}Z "
                            "ballpistond: warning: b\n"));
}

}  // namespace
}  // namespace ballpiston::server
