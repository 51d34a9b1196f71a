// The contract of the command line, as pages of commands with their output: transcripts/*.txt. Each
// page is a test. transcripts/README.md describes a page, and says how to write the output again.
#include <google/protobuf/descriptor.h>
#include <gtest/gtest-spi.h>

#include <list>
#include <regex>

#include "absl/strings/numbers.h"
#include "google/rpc/status.pb.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

bool IsIndented(const std::string& line) { return line.starts_with("  "); }
bool IsCommand(const std::string& line) { return line.starts_with("  $ "); }

// Whether the line belongs to the output of the command above it. An empty line does if more output
// follows.
bool IsOutput(const std::vector<std::string>& lines, size_t i) {
  while (i < lines.size() && lines[i].empty()) ++i;
  return i < lines.size() && IsIndented(lines[i]) && !IsCommand(lines[i]);
}

// The indented lines from the line `begin` on, without their indentation.
std::string Block(const std::vector<std::string>& lines, size_t begin) {
  std::string block;
  for (size_t i = begin; i < lines.size() && IsIndented(lines[i]); ++i) {
    absl::StrAppend(&block, lines[i].substr(2), "\n");
  }
  return block;
}

// The text with `before` in front of each line; an empty line stays empty.
std::string Indented(const std::string& text, const std::string& before) {
  std::string indented;
  for (const absl::string_view line : absl::StrSplit(absl::StripSuffix(text, "\n"), '\n')) {
    absl::StrAppend(&indented, line.empty() ? "" : before, line, "\n");
  }
  if (!text.ends_with('\n')) absl::StrAppend(&indented, before, "[no end of line]\n");
  return text.empty() ? "" : indented;
}

// The words of a command, as a shell reads them. A word may be quoted: 'a b', ''.
std::vector<std::string> ShellWords(const std::string& command) {
  std::vector<std::string> words;
  bool is_quoted = false, is_in_word = false;
  for (const char c : command) {
    if (c == '\'') is_quoted = !is_quoted;
    const bool was_in_word = std::exchange(is_in_word, is_quoted || c != ' ');
    if (is_in_word && !was_in_word) words.emplace_back();
    if (is_in_word && c != '\'') words.back() += c;
  }
  return words;
}

// Runs the commands of a page in an empty home folder, which is the current folder. The variable
// BALLPISTON_SERVER names a fake server, which is also the private server.
class Replay : public ProgramTest {
 protected:
  Replay() {
    server_.Start();
    home_.UseAsPrivateServer(server_.Address());
    fs::current_path(folder_);
  }
  ~Replay() override { fs::current_path(old_folder_); }

  // The page with the true output of its commands.
  std::string Replayed(const std::string& page) {
    std::string replayed;
    const std::vector<std::string> lines = absl::StrSplit(absl::StripSuffix(page, "\n"), '\n');
    for (size_t i = 0; i < lines.size(); ++i) {
      const std::string& line = lines[i];
      absl::StrAppend(&replayed, line, "\n");
      if (IsCommand(line)) {
        replayed += OutputOf(WithMeanings(line.substr(4)));
        while (IsOutput(lines, i + 1)) ++i;
      } else if (absl::string_view given = line; absl::ConsumePrefix(&given, "Given ")) {
        Give(std::string(absl::StripSuffix(given, ":")), WithMeanings(Block(lines, i + 1)));
      } else if (absl::string_view usual = line;
                 absl::ConsumePrefix(&usual, "Each command below exits with ")) {
        EXPECT_TRUE(absl::SimpleAtoi(absl::StripSuffix(usual, "."), &usual_code_)) << line;
      }
    }
    return replayed;
  }

 private:
  std::string OutputOf(const std::string& command) {
    const Outcome outcome = Run(ShellWords(command));
    return WithMasks(absl::StrCat(
        Indented(outcome.out, "  "), Indented(outcome.err, "  ! "),
        outcome.code == usual_code_ ? "" : absl::StrCat("  [exit ", outcome.code, "]\n")));
  }

  Outcome Run(std::vector<std::string> words) {
    std::list<ScopedVariable> variables;
    while (!words.empty() && absl::StrContains(words.front(), '=')) {
      const std::pair<std::string, std::string> setting =
          absl::StrSplit(words.front(), absl::MaxSplits('=', 1));
      variables.emplace_back(setting.first, setting.second);
      words.erase(words.begin());
    }
    const std::string program = words.at(0);
    words.erase(words.begin());
    if (program == "ballpiston") return Ballpiston(words);
    if (program == "cat" && fs::exists(words.at(0))) return {usual_code_, Contents(words[0]), ""};
    if (program == "last-request") return {usual_code_, LastRequest(words.at(0)), ""};
    return {usual_code_, "", absl::StrCat(program, ": not found\n")};
  }

  std::string LastRequest(const std::string& call) {
    using google::protobuf::DescriptorPool;
    EXPECT_NE(DescriptorPool::generated_pool()->FindMessageTypeByName(
                  absl::StrCat("ballpiston.v1.", call, "Request")),
              nullptr)
        << call << " is not a call";
    const google::protobuf::Message* const request = server_.LastAsked(call);
    return absl::StrCat(request == nullptr ? "none" : request->ShortDebugString(), "\n");
  }

  // Prepares an answer of the server, in the text format of its message, or writes a file.
  void Give(const std::string& name, const std::string& text) {
    if (absl::string_view file = name; absl::ConsumePrefix(&file, "file ")) {
      const fs::path path = fs::absolute(std::string(file));
      fs::create_directories(path.parent_path());
      WriteFile(path, text);
    } else if (name == "jobs") {
      const auto page = FromText<v1::ListEnsembleJobsResponse>(text);
      server_.jobs.assign(page.jobs().begin(), page.jobs().end());
      if (!server_.jobs.empty()) server_.watches[0].messages = {JobMessage(job(), "t")};
    } else if (name == "results") {
      const auto page = FromText<v1::ListResultsResponse>(text);
      server_.points.assign(page.results().begin(), page.results().end());
    } else if (name == "plan") {
      server_.plan = FromText<v1::PlanEnsembleJobResponse>(text);
    } else if (name == "closed forms") {
      server_.closed_forms = FromText<v1::EvaluatePairsResponse>(text);
    } else if (name == "status") {
      server_.status = FromText<v1::ServerStatus>(text);
    } else if (name == "orbit") {
      server_.orbit = {FromText<v1::TraceOrbitResponse>(text)};
    } else if (name == "error") {  // of all calls that submit, plan or trace
      const auto error = FromText<google::rpc::Status>(text);
      server_.create_end = server_.plan_end = server_.trace_end =
          grpc::Status(static_cast<grpc::StatusCode>(error.code()), error.message(),
                       error.details().empty() ? "" : error.SerializeAsString());
    } else if (name == "violations") {
      constexpr char kType[] = "details { [type.googleapis.com/google.rpc.";
      Give("error", absl::StrCat("code: 3 message: 'the specification is not valid' ", kType,
                                 "ErrorInfo] { reason: 'INVALID_SPEC' } } ", kType,
                                 "BadRequest] { ", text, " } }"));
    } else {
      ADD_FAILURE() << "nothing can be given as: " << name;
    }
  }

  // $FOLDER, $SERVER, $VERSION, and times in whole hours from now: $NOW+84h, $NOW-240h.
  std::string WithMeanings(const std::string& text) {
    std::string meant = absl::StrReplaceAll(text, masks_);
    for (size_t at; (at = meant.find("$NOW")) != std::string::npos;) {
      const size_t end = meant.find('h', at) + 1;
      const std::string mask = meant.substr(at, end - at);
      absl::Duration from_now;
      EXPECT_TRUE(absl::ParseDuration(mask.substr(4), &from_now)) << mask;
      const absl::Time time = now_ + from_now;
      times_[absl::FormatTime("%Y-%m-%dT%H:%M:%SZ", time, absl::UTCTimeZone())] = mask;
      meant.replace(at, mask.size(), absl::StrCat(absl::ToUnixSeconds(time)));
    }
    return meant;
  }

  std::string WithMasks(std::string text) const {
    for (const auto& [mask, meaning] : masks_) absl::StrReplaceAll({{meaning, mask}}, &text);
    absl::StrReplaceAll(times_, &text);
    static const std::regex kRandomUuid(
        "[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[0-9a-f]{4}-[0-9a-f]{12}");
    return std::regex_replace(text, kRandomUuid, "$$UUID");
  }

  const fs::path old_folder_ = fs::current_path(),
                 folder_ = fs::path(home_.File(".")).parent_path();
  const ScopedVariable address_{"BALLPISTON_SERVER", server_.Address()};
  const absl::Time now_ = absl::Now();
  const std::map<std::string, std::string> masks_ = {
      {"$FOLDER", folder_}, {"$SERVER", server_.Address()}, {"$VERSION", BALLPISTON_VERSION}};
  std::map<std::string, std::string> times_;
  int usual_code_ = 0;
};

class Transcripts : public Replay, public testing::WithParamInterface<std::string> {};

TEST_P(Transcripts, EachCommandHasItsOutput) {
  const std::string path = SourcePath("tests/client/transcripts/" + GetParam() + ".txt");
  const std::string page = Contents(path), replayed = Replayed(page);
  if (std::getenv("BALLPISTON_REWRITE") != nullptr) return WriteFile(path, replayed);
  EXPECT_EQ(replayed, page);
}

std::vector<std::string> PageNames() {
  std::vector<std::string> names;
  for (const std::string& name : NamesIn(SourcePath("tests/client/transcripts"))) {
    if (name.ends_with(".txt")) names.push_back(name.substr(0, name.find('.')));
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Client, Transcripts, testing::ValuesIn(PageNames()),
                         [](const auto& page) { return page.param; });

// The test above can fail.
TEST_F(Replay, ReplacesWrongOutput) {
  const std::string submit = "About jobs.\n\n  $ ballpiston submit equilibrium\n";
  const std::string result = "\n  $ ballpiston result none\n", end = "\nThe end.\n";
  EXPECT_EQ(Replayed(submit + "  ensembleJobs/other\n\n  of two lines\n" + result + end),
            submit + "  ensembleJobs/abc\n" + result +
                "  ! ballpiston: no such job: ensembleJobs/none (JOB_NOT_FOUND)\n  [exit 5]\n" +
                end);
}

TEST_F(Replay, LastRequestNeedsTheNameOfACall) {
  EXPECT_NONFATAL_FAILURE(Replayed("  $ last-request Create\n"), "Create is not a call");
}

}  // namespace
}  // namespace ballpiston::client
