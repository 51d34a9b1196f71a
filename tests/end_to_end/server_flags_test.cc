// The flags of ballpistond: their spelling, their permitted values, and the file of --config.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/end_to_end/programs.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;

ProcessResult Server(const Words& flags) {
  const TemporaryFolder home;
  return RunServer(home, flags);
}

// Runs the server with flags that it refuses, and returns its error, which is one line.
std::string Refusal(const Words& flags) {
  const ProcessResult result = Server(flags);
  EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(flags) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  return result.err;
}

// ---- spelling ----

const char* const kFlags[] = {"listen",
                              "data-dir",
                              "workers",
                              "watch-heartbeat-seconds",
                              "idle-exit-seconds",
                              "drain-seconds",
                              "config",
                              "socket-mode",
                              "socket-group",
                              "loopback-role",
                              "tls-certificate",
                              "tls-key",
                              "tls-client-ca",
                              "access-file",
                              "max-active-jobs",
                              "max-active-jobs-per-principal",
                              "max-active-points",
                              "max-active-points-per-principal",
                              "max-points-per-job",
                              "max-samples-per-job",
                              "max-streams",
                              "max-streams-per-principal",
                              "max-calls-per-principal",
                              "max-call-bytes-per-principal",
                              "retain-days",
                              "max-store-bytes",
                              "max-transfer-mib",
                              "max-memory-mib",
                              "executor",
                              "slurm-shared-folder",
                              "slurm-partition",
                              "slurm-account",
                              "slurm-cluster",
                              "slurm-time-limit-minutes",
                              "slurm-option",
                              "slurm-max-tasks",
                              "slurm-max-array-size",
                              "slurm-task-seconds",
                              "slurm-least-seconds",
                              "slurm-query-seconds",
                              "slurm-worker",
                              "max-message-bytes",
                              "log-format",
                              "log-level",
                              "metrics-listen",
                              "new-token",
                              "check",
                              "backup",
                              "verify",
                              "version",
                              "help"};

// What --help describes: --NAME at the beginning of a line.
std::multiset<std::string> FlagsOf(const std::string& page) {
  std::multiset<std::string> flags;
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  -")) continue;
    std::string names;
    std::istringstream(line) >> names;
    std::istringstream spellings(names);
    for (std::string name; std::getline(spellings, name, ',');) flags.insert(name);
  }
  return flags;
}

TEST(ServerFlags, HelpListsEachOnceWithDashes) {
  const ProcessResult help = Server({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.err, "");
  std::multiset<std::string> expected = {"--data_dir", "-h"};
  for (const std::string flag : kFlags) expected.insert("--" + flag);
  EXPECT_EQ(FlagsOf(help.out), expected);
  EXPECT_EQ(FlagsOf(Server({"-h"}).out), expected);
}

TEST(ServerFlags, HelpListsDefaultsAndExitCodesInShortLines) {
  const std::string page = Server({"--help"}).out;
  EXPECT_THAT(page, HasSubstr("\n\nLimits; 0 means no limit:\n"));
  EXPECT_THAT(page, HasSubstr("--max-active-jobs N\n"));
  EXPECT_THAT(page, HasSubstr("jobs that have not ended, of all principals; default: 10000\n"));
  EXPECT_THAT(page, HasSubstr("default: 1e+15"));
  EXPECT_THAT(page, HasSubstr("--drain-seconds SECONDS\n"));
  EXPECT_THAT(page, HasSubstr("default: 10\n"));
  EXPECT_THAT(page, HasSubstr("default: text\n"));
  EXPECT_THAT(page, HasSubstr(".local/state/ballpiston\n"));
  EXPECT_THAT(page, HasSubstr("threads that compute; whole numbers from 1 to 1024; default: "));
  EXPECT_THAT(page, HasSubstr("Exit codes: 0 stopped (SIGTERM, SIGINT, idle) or done; 1 "));
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << line;
}

TEST(ServerFlags, HelpAndVersionArePrintedBesideAWrongFlag) {
  for (const Words& wrong :
       {Words{"--workers=0"}, Words{"--nonsense"}, Words{"--config=nowhere"}}) {
    for (const std::string page : {"--help", "--version"}) {
      Words flags = wrong;
      flags.push_back(page);
      const ProcessResult result = Server(flags);
      EXPECT_EQ(result.exit_code, 0) << result.err;
      EXPECT_THAT(result.out, HasSubstr("ballpistond"));
    }
  }
}

TEST(ServerFlags, DataDirIsAlsoSpelledWithAnUnderscore) {
  const TemporaryFolder home;
  const std::string address = "unix:" + home.File("socket");
  Process server(ServerCommand(
      home, {"--listen", address, "--data_dir", home.File("data"), "--workers", "1"}));
  ASSERT_TRUE(server.WaitForErr("listening on " + address));
  for (const Words& spelling :
       {Words{"--data-dir", home.File("data")}, Words{"--data-dir=" + home.File("data")},
        Words{"--data_dir=" + home.File("data")}}) {
    Words flags = spelling;
    flags.push_back("--check");
    EXPECT_THAT(Server(flags).out, HasSubstr("the store is sound"));
  }
}

TEST(ServerFlags, AnotherUnderscoreIsRefusedByName) {
  EXPECT_THAT(Refusal({"--max_active_jobs=3"}),
              HasSubstr("--max_active_jobs is not a flag; it is spelled --max-active-jobs"));
  EXPECT_THAT(Refusal({"--workers", "2", "--access_file", "access", "--listen", "unix:x"}),
              HasSubstr("--access_file is not a flag; it is spelled --access-file"));
}

TEST(ServerFlags, AnUnknownFlagOrArgumentIsNamed) {
  EXPECT_THAT(Refusal({"--nonsense=1"}), HasSubstr("--nonsense is not a flag; --help lists them"));
  EXPECT_THAT(Refusal({"-workers=1"}),
              HasSubstr("-workers is not a flag; it is spelled --workers"));
  for (const Words& flags : {Words{"data"}, Words{"--check", "data"}, Words{"--", "data"}}) {
    EXPECT_THAT(Refusal(flags), HasSubstr("unexpected argument \"data\""));
  }
  EXPECT_THAT(Refusal({"-"}), HasSubstr("- is not a flag"));
  EXPECT_THAT(Refusal({""}), HasSubstr("unexpected argument \"\""));
}

// ---- values ----

TEST(ServerFlags, AValueOutOfRangeIsNamedWithTheRange) {
  const std::string workers = "permitted: whole numbers from 1 to 1024";
  const std::string seconds = "permitted: 0 to 3600";
  const std::string limit = "permitted: whole numbers from 0 (no limit) to 9223372036854775807";
  const std::string real_limit = "permitted: 0 (no limit) to 1.79769313486232e+308";
  const struct {
    Words flags;
    std::string message;
  } table[] = {
      {{"--workers=0"}, "--workers=0 is out of range; " + workers},
      {{"--workers=1025"}, "--workers=1025 is out of range; " + workers},
      {{"--workers", "-1"}, "--workers=-1 is out of range; " + workers},
      {{"--workers=2.5"}, "--workers=2.5 is not a whole number; " + workers},
      {{"--workers=0.5"}, "--workers=0.5 is out of range; " + workers},
      {{"--workers=02000"}, "--workers=02000 is out of range; " + workers},  // not octal: 1024
      {{"--workers=1e4"}, "--workers=1e4 is out of range; " + workers},
      {{"--workers=99999999999999999999"}, "99999999999999999999 is out of range; " + workers},
      {{"--workers=many"}, "--workers=many is not a number; " + workers},
      {{"--workers="}, "--workers= is not a number; " + workers},
      {{"--workers", ""}, "--workers= is not a number; " + workers},
      {{"--drain-seconds", "-1"}, "--drain-seconds=-1 is out of range; " + seconds},
      {{"--drain-seconds=nan"}, "--drain-seconds=nan is not a number; " + seconds},
      {{"--drain-seconds=-inf"}, "--drain-seconds=-inf is out of range; " + seconds},
      {{"--drain-seconds=1e300"}, "--drain-seconds=1e300 is out of range; " + seconds},
      {{"--drain-seconds=10s"}, "--drain-seconds=10s is not a number; " + seconds},
      {{"--idle-exit-seconds=1e7"},
       "--idle-exit-seconds=1e7 is out of range; permitted: 0 (never) to 1000000"},
      {{"--watch-heartbeat-seconds=0"}, "permitted: 0.01 to 3600"},
      {{"--max-active-jobs", "-1"}, "--max-active-jobs=-1 is out of range; " + limit},
      {{"--max-active-jobs=1e30"}, "--max-active-jobs=1e30 is out of range; " + limit},
      {{"--max-active-jobs=9223372036854775808"}, "9223372036854775808 is out of range; " + limit},
      {{"--max-samples-per-job", "-1e-9"},
       "--max-samples-per-job=-1e-9 is out of range; " + real_limit},
      {{"--max-samples-per-job=inf"}, "--max-samples-per-job=inf is out of range; " + real_limit},
      {{"--max-samples-per-job=nan"}, "--max-samples-per-job=nan is not a number; " + real_limit},
      {{"--max-message-bytes=1023"}, "permitted: whole numbers from 1024 to 268435456"},
      {{"--max-transfer-mib=15"}, "permitted: 0 (no limit), or 16 to 1048576"},
      {{"--max-transfer-mib=1048577"}, "permitted: 0 (no limit), or 16 to 1048576"},
      {{"--max-transfer-mib=31", "--max-message-bytes=16777216"},
       "or 32 to 1048576 with --max-message-bytes=16777216"},
      {{"--log-format=xml"}, "--log-format=xml is unknown; permitted: text, json"},
      {{"--log-level", "-1"}, "--log-level=-1 is unknown; permitted: info, warning, error"},
      {{"--socket-mode=0777"}, "--socket-mode=0777 is unknown; permitted: 0600, 0660, 0666"},
      {{"--loopback-role=root"}, "--loopback-role=root is unknown; permitted: submit, read, admin"},
  };
  for (const auto& row : table) {
    Words flags = row.flags;
    flags.push_back("--check");  // starts no server, even if a value is accepted by mistake
    EXPECT_THAT(Refusal(flags), HasSubstr(row.message));
  }
}

TEST(ServerFlags, AFlagHasOneValue) {
  EXPECT_THAT(Refusal({"--workers"}), HasSubstr("--workers needs a value"));
  EXPECT_THAT(Refusal({"--listen", "unix:x", "--data-dir"}), HasSubstr("--data-dir needs a value"));
  EXPECT_THAT(Refusal({"--workers=2", "--workers", "2"}),
              HasSubstr("--workers is given more than once"));
  EXPECT_THAT(Refusal({"--data-dir=a", "--data_dir=b"}),
              HasSubstr("--data-dir is given more than once"));
  EXPECT_THAT(Refusal({"--config=a", "--config=b"}), HasSubstr("--config is given more than once"));
}

// A shell passes an empty value if a variable is not set. The server then takes neither the default
// nor the next flag as the value.
TEST(ServerFlags, AnEmptyValueIsRefused) {
  for (const std::string flag : {"--listen", "--data-dir", "--config", "--access-file",
                                 "--tls-certificate", "--metrics-listen", "--backup"}) {
    for (const Words& flags : {Words{flag + "=", "--workers=1"}, Words{flag, "", "--workers=1"}}) {
      EXPECT_THAT(Refusal(flags), HasSubstr(flag + " needs a value"));
    }
  }
}

// ---- the file of --config ----

class ConfigFile : public testing::Test {
 protected:
  void Write(const std::string& text) const { WriteFile(Path(), text); }
  std::string Path() const { return home_.File("ballpistond.conf"); }

  // The error of a server with `text` as its file of --config.
  std::string RefusalOf(const std::string& text, Words flags = {}) const {
    Write(text);
    flags.insert(flags.begin(), {"--config", Path()});
    return Refusal(flags);
  }

  TemporaryFolder home_;
};

TEST_F(ConfigFile, GivesTheFlagsOfAServer) {
  const std::string address = "unix:" + home_.File("socket");
  Write("# of the laboratory\n\n  listen = \"" + address +
        "\"  # the API\ndata-dir=" + home_.File("data") +
        "\nworkers = 1 # one\nlog-format = json\nmax-points-per-job = 2\nmax-active-points = 3e7");
  Process server(ServerCommand(home_, {"--config=" + Path()}));
  ASSERT_TRUE(server.WaitForErr("listening on " + address));
  EXPECT_TRUE(std::filesystem::exists(home_.File("data/store.sqlite3")));
  const ProcessResult status =
      RunProgram(ClientCommand(home_, {"status", "--format", "json", "--server", address}));
  EXPECT_EQ(At(ParseJson(status.out), "workers").number_value(), 1) << status.out << status.err;
  EXPECT_EQ(At(ParseJson(status.out), "limits", "max_points_per_job").number_value(), 2);
  EXPECT_EQ(At(ParseJson(status.out), "limits", "max_active_points").number_value(), 3e7);
  server.Signal(SIGTERM);
  EXPECT_THAT(server.Wait().err, testing::StartsWith("{"));
}

TEST_F(ConfigFile, CommandLineTakesPrecedence) {
  const std::string text = "data-dir = /of/the/file\nworkers = 0\n";
  EXPECT_THAT(RefusalOf(text, {"--data-dir=/of/the/line", "--workers=1", "--check"}),
              HasSubstr("/of/the/line/store.sqlite3"));
  EXPECT_THAT(RefusalOf(text, {"--workers=1", "--check"}), HasSubstr("/of/the/file/store.sqlite3"));
  EXPECT_THAT(RefusalOf(text, {"--check"}), HasSubstr("--workers=0 is out of range"));
}

TEST_F(ConfigFile, HasValuesWithOddCharacters) {
  const struct {
    std::string value;
    std::string folder;
  } table[] = {{"\"/a#b\"", "/a#b/store"},     {"/a b, c", "/a b, c/store"},
               {"[/a]", "[/a]/store"},         {"\"/a=b\" # c", "/a=b/store"},
               {"  /a # \"b\"  ", "/a/store"}, {"'/a'", "'/a'/store"}};
  for (const auto& row : table) {
    EXPECT_THAT(RefusalOf("data-dir = " + row.value + "\nworkers = 1\n", {"--check"}),
                HasSubstr(" " + row.folder));
  }
}

TEST_F(ConfigFile, NamesTheLineThatIsWrong) {
  const struct {
    std::string text;
    std::string message;
  } table[] = {
      {"listn = \"unix:x\"\n", ", line 1: listn is not a flag; --help lists them"},
      {"# flags\n\nmax_streams = 3\n",
       ", line 3: max_streams is not a flag; it is spelled --max-streams"},
      {"--workers = 3\n", ", line 1: --workers is not a flag"},
      {"--workers=3\n", ", line 1: --workers is not a flag"},
      {"workers = 1\nworkers = 2\n", ", line 2: workers is given twice"},
      {"data-dir = a\nworkers = 2\ndata_dir = b\n", ", line 3: data_dir is given twice"},
      {"check = true\n", ", line 1: check is permitted on the command line only"},
      {"check\n", ", line 1: check is permitted on the command line only"},
      {"config = other\n", ", line 1: config is permitted on the command line only"},
      {"help\n", ", line 1: help is permitted on the command line only"},
      {"[server]\nworkers = 1\n", ", line 1: [server] is not a flag"},
      {"workers\n", ", line 1: write workers = \"VALUE\""},
      {"listen = \"unix:x\n", ", line 1: write listen = \"VALUE\""},
      {"listen = \"unix:x\" y\n", ", line 1: write listen = \"VALUE\""},
      {"= 3\n", ", line 1:  is not a flag"},
  };
  for (const auto& row : table) {
    EXPECT_THAT(RefusalOf(row.text, {"--check"}), HasSubstr("--config=" + Path() + row.message));
  }
}

TEST_F(ConfigFile, MustBeAReadableFile) {
  const std::string missing = home_.File("missing.conf");
  EXPECT_THAT(Refusal({"--config", missing}),
              HasSubstr("--config=" + missing + " is not a file that can be read"));
  const std::string folder = home_.path();
  EXPECT_THAT(Refusal({"--config", folder}),
              HasSubstr("--config=" + folder + " is not a file that can be read"));
}

TEST_F(ConfigFile, ShippedFileNamesTheFilesThatAPublicServerNeeds) {
  const std::string shipped = SourcePath("server/systemd/ballpistond.conf");
  const std::string refusal =
      Refusal({"--config", shipped, "--data-dir", home_.File("data"), "--access-file",
               home_.File("access"), "--tls-certificate", home_.File("certificate.pem")});
  // All flags are accepted; only the files do not exist.
  EXPECT_THAT(refusal, HasSubstr(home_.File("access") + ": cannot be opened"));
}

}  // namespace
}  // namespace ballpiston
