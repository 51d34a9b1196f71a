#include "server/status/log.h"

#include <string>
#include <vector>

#include "gmock/gmock.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

std::string Warning(const std::string& message, LogFields fields = {}) {
  return LogLine(Severity::kWarning, message, fields);
}

// Texts that try to add a line to the log or to control a terminal.
std::vector<std::string> HostileTexts() {
  std::vector<std::string> texts = {"a\nballpistond: error: a false line",
                                    "\x1b[2J\x1b]0;title\x07",
                                    "next\xC2\x85line, \xE2\x80\xA8line, \xE2\x80\xA9paragraph",
                                    "right to left \xE2\x80\xAE",
                                    std::string("nul\0inside", 10),
                                    std::string(100'000, '\x01'),
                                    std::string(100'000, '"')};
  for (int c = 0; c < 256; ++c) texts.push_back(std::string(1, static_cast<char>(c)));
  return texts;
}

TEST(LogLine, IsAMessageForPeople) {
  EXPECT_EQ(Warning("the server's \"disk\"", {{"job", "ensembleJobs/1"},
                                              {"who", "a \"b\""},
                                              {"empty", ""},
                                              {"n", 3},
                                              {"seconds", 0.25}}),
            "ballpistond: warning: the server's \"disk\" "
            "(job=ensembleJobs/1 who=\"a \\\"b\\\"\" n=3 seconds=0.25)\n");
  EXPECT_EQ(LogLine(Severity::kInfo, "stopping"), "ballpistond: stopping\n");
  EXPECT_EQ(LogLine(Severity::kError, "a\n\xC3\xA9"), "ballpistond: error: a\\n\\xc3\\xa9\n");
}

TEST(LogLine, AnyTextGivesOneLineOfPrintableCharacters) {
  for (const std::string& text : HostileTexts()) {
    const std::string line = Warning(text, {{"principal", text}, {"code", "INTERNAL"}});
    EXPECT_EQ(line.find_first_of('\n'), line.size() - 1);
    EXPECT_LE(line.size(), kMaxLogLine);
    for (const char c : line.substr(0, line.size() - 1)) EXPECT_TRUE(c >= ' ' && c <= '~') << line;
    EXPECT_THAT(line, HasSubstr(" code=INTERNAL)\n"));
  }
}

TEST(Log, LinesHaveATimeAndAtLeastTheChosenSeverity) {
  SetLogLevel(Severity::kWarning);
  testing::internal::CaptureStderr();
  Log(Severity::kInfo, "a");
  Log(Severity::kWarning, "b");
  SetLogLevel(Severity::kNone);
  Log(Severity::kError, "c");
  SetLogLevel(Severity::kInfo);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}\\.[0-9]{3}Z "
                           "ballpistond: warning: b\n"));
}

}  // namespace
}  // namespace ballpiston::server
