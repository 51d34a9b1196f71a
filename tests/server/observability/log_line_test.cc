#include "server/observability/log_line.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "google/protobuf/struct.pb.h"
#include "google/protobuf/util/json_util.h"
#include "gtest/gtest.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const absl::Time kNow = absl::FromUnixMicros(1'700'000'000'123'456);

google::protobuf::Struct Parsed(const std::string& line) {
  google::protobuf::Struct object;
  const auto status = google::protobuf::util::JsonStringToMessage(line, &object);
  EXPECT_TRUE(status.ok()) << status.ToString() << "\n" << line;
  return object;
}

std::string TextIn(const google::protobuf::Struct& object, const std::string& name) {
  const auto found = object.fields().find(name);
  return found == object.fields().end() ? "(none)" : found->second.string_value();
}

std::string Json(const std::string& message, LogFields fields = {}) {
  return LogLine(LogFormat::kJson, kNow, Severity::kError, message, fields);
}

std::string Text(const std::string& message, LogFields fields = {}) {
  return LogLine(LogFormat::kText, kNow, Severity::kWarning, message, fields);
}

// Texts that try to add a line to the log or to control a terminal.
std::vector<std::string> HostileTexts() {
  std::vector<std::string> texts = {"a\nballpistond: error: a false line",
                                    "a\r\n{\"severity\":\"ERROR\"}",
                                    "\",\"severity\":\"INFO\",\"x\":\"",
                                    "\\",
                                    "\\\"\\u000a",
                                    "\x1b[2J\x1b]0;title\x07",
                                    "next\xC2\x85line, \xE2\x80\xA8line, \xE2\x80\xA9paragraph",
                                    "right to left \xE2\x80\xAE",
                                    "\xC3",
                                    "\xC0\x80\xED\xA0\x80\xF5\x80\x80\x80\xFF",
                                    "\xF0\x9F\x8E\xB1 and \xC3\xA9",
                                    std::string("nul\0inside", 10),
                                    std::string(100'000, '\x01'),
                                    std::string(100'000, '"')};
  for (int c = 0; c < 256; ++c) texts.push_back(std::string(1, static_cast<char>(c)));
  return texts;
}

TEST(LogLine, JsonIsOneObjectWithTimeSeverityMessageAndFields) {
  EXPECT_EQ(Json("job accepted", {{"job", "ensembleJobs/1"}, {"seconds", 0.25}, {"empty", ""}}),
            "{\"time\":\"2023-11-14T22:13:20.123456Z\",\"severity\":\"ERROR\","
            "\"message\":\"job accepted\",\"job\":\"ensembleJobs/1\",\"seconds\":0.25}\n");
}

TEST(LogLine, TextIsAMessageForPeople) {
  EXPECT_EQ(Text("the disk is full", {{"job", "ensembleJobs/1"}, {"who", "a b"}, {"n", 3}}),
            "ballpistond: warning: the disk is full (job=ensembleJobs/1 who=\"a b\" n=3)\n");
  EXPECT_EQ(Text("stopping"), "ballpistond: warning: stopping\n");
}

TEST(LogLine, AnyTextGivesOneLineOfJsonWithTheSameFields) {
  for (const std::string& text : HostileTexts()) {
    const std::string line = Json(text, {{"principal", text}, {"code", "INTERNAL"}});
    EXPECT_EQ(line.find_first_of('\n'), line.size() - 1);
    EXPECT_LE(line.size(), kMaxLogLine);
    for (const char c : line.substr(0, line.size() - 1)) EXPECT_TRUE(c >= 0x20 && c < 0x7F);
    const auto object = Parsed(line);
    EXPECT_EQ(object.fields_size(), 5) << line;
    EXPECT_EQ(TextIn(object, "severity"), "ERROR");
    EXPECT_EQ(TextIn(object, "code"), "INTERNAL");
  }
}

TEST(LogLine, AnyTextGivesOneLineWithoutControlCharacters) {
  for (const std::string& text : HostileTexts()) {
    const std::string line = Text(text, {{"principal", text}, {"code", "INTERNAL"}});
    EXPECT_EQ(line.find_first_of('\n'), line.size() - 1);
    EXPECT_LE(line.size(), kMaxLogLine);
    for (const char c : line.substr(0, line.size() - 1)) {
      EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7F) << line;
    }
    for (const char* breaks : {"\xC2\x85", "\xE2\x80\xA8", "\xE2\x80\xA9", "\xE2\x80\xAE"}) {
      EXPECT_THAT(line, Not(HasSubstr(breaks)));
    }
    EXPECT_THAT(line, HasSubstr(" code=INTERNAL)\n"));
  }
}

TEST(LogLine, ReadableTextIsUnchangedInJson) {
  for (const std::string text : {"plain", "\"quoted\" \\ back", "tab\tand\nnewline",
                                 "\xC3\xA9\xE2\x82\xAC", "\xF0\x9F\x8E\xB1"}) {
    EXPECT_EQ(TextIn(Parsed(Json(text)), "message"), text);
  }
}

TEST(LogLine, InvalidUtf8BecomesReplacementCharacters) {
  EXPECT_EQ(TextIn(Parsed(Json("a\xC3z")), "message"), "a\xEF\xBF\xBDz");
  EXPECT_EQ(TextIn(Parsed(Json("\xC0\x80")), "message"), "\xEF\xBF\xBD\xEF\xBF\xBD");
}

TEST(LogLine, ALongMessageIsCutBetweenTwoCharacters) {
  const auto message = [](const std::string& text) {
    return TextIn(Parsed(Json(text)), "message");
  };
  EXPECT_EQ(message(std::string(1500, 'x')), std::string(1500, 'x'));
  EXPECT_EQ(message(std::string(1501, 'x')), std::string(1500, 'x') + "...");
  EXPECT_EQ(message(std::string(1499, 'x') + "\"y"), std::string(1499, 'x') + "...");
  EXPECT_EQ(message(std::string(1498, 'x') + "\"y"), std::string(1498, 'x') + "\"...");
}

TEST(LogLine, TwelveLongFieldsStillFitIntoALine) {
  const std::string text(1000, '"');
  EXPECT_LE(Json(text, {{"a", text},
                        {"b", text},
                        {"c", text},
                        {"d", text},
                        {"e", text},
                        {"f", text},
                        {"g", text},
                        {"h", text},
                        {"i", text},
                        {"j", text},
                        {"k", text},
                        {"l", text}})
                .size(),
            kMaxLogLine);
}

TEST(LogLine, InfinityAndNanAreNullInJson) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double number : {infinity, -infinity, std::nan("")}) {
    const auto object = Parsed(Json("", {{"x", number}}));
    EXPECT_TRUE(object.fields().at("x").has_null_value());
  }
}

}  // namespace
}  // namespace ballpiston::server
