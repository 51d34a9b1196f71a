// The flags of ballpistond: help, permitted values, and the file of --config.
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

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

TEST(ServerFlags, HelpHasDefaultsRangesAndExitCodesInShortLines) {
  const ProcessResult help = Server({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.err, "");
  EXPECT_EQ(Server({"-h"}).out, help.out);
  for (const char* text :
       {"\n\nLimits; 0 means no limit:\n", "--max-streams N:0 to 32768=2048\n",
        "--drain-seconds SECONDS:0 to 3600=10\n", "{info,warning,error}=info\n",
        "Default: ~/.local/state/ballpiston;", "--workers N:1 to 1024\n", "\n  --slurm-cluster ",
        "Exit codes: 0 stopped (SIGTERM, SIGINT, idle) or done; 1 "}) {
    EXPECT_THAT(help.out, HasSubstr(text));
  }
  EXPECT_THAT(Words(absl::StrSplit(help.out, '\n')), Each(SizeIs(::testing::Le(100u))));
}

// ---- refusals ----

TEST(ServerFlags, ARefusalNamesFlagValueAndPermittedValues) {
  const std::string workers = " is refused; permitted: whole numbers, 1 to 1024";
  const std::string seconds = " is refused; permitted: 0 to 3600";
  const struct {
    Words flags;
    std::string message;
  } table[] = {
      {{"--nonsense=1"}, "not expected: --nonsense=1"},
      {{"-workers=1"}, "not expected: -workers=1"},
      {{"data"}, "not expected: data"},
      {{"--workers=2", "--workers", "2"}, "--workers: At Most 1"},
      {{"--backup", "copy"}, "--check excludes --backup"},
      {{"--workers=0"}, "--workers: 0" + workers},
      {{"--workers=1025"}, "--workers: 1025" + workers},
      {{"--workers", "-1"}, "--workers: -1" + workers},
      {{"--workers=2.5"}, "--workers: 2.5" + workers},
      {{"--workers=02000"}, "--workers: 02000" + workers},  // not octal: 1024
      {{"--workers=99999999999999999999"}, "99999999999999999999" + workers},
      {{"--workers", ""}, "--workers: " + workers},
      {{"--drain-seconds=nan"}, "--drain-seconds: nan" + seconds},
      {{"--drain-seconds=10s"}, "--drain-seconds: 10s" + seconds},
      {{"--idle-exit-seconds=1e7"}, "permitted: 0 to 1000000"},
      {{"--watch-heartbeat-seconds=0"}, "permitted: 0.01 to 3600"},
      {{"--max-streams", "40000"},
       "--max-streams: 40000 is refused; permitted: whole numbers, 0 to 32768"},
      {{"--max-points-per-job=1e30"}, "1e30 is refused; permitted: whole numbers, 0 to 1e+15"},
      {{"--retain-days=1e-320"},
       "--retain-days: 1e-320 is refused; permitted: 0, or 0.001 to 1e+15"},
      {{"--max-store-bytes=10"}, "10 is refused; permitted: whole numbers, 0, or 1000000 to 1e+15"},
      {{"--log-level", "-1"}, "--log-level: -1 not in {info,warning,error}"},
      {{"--executor=slurm"}, "--cluster-folder: \"\" is not an absolute path"},
      {{"--executor=folder", "--cluster-folder=a"}, "\"a\" is not an absolute path"},
      {{"--cluster-folder=/a"}, "--cluster-folder needs --executor=folder"},
      {{"--new-token", "alice:read"}, "--new-token requires --access-file"},
      {{"--config=none"}, "none was not readable"},
      {{"--config=/"}, "/ was not readable"},
  };
  for (const auto& row : table) {
    Words flags = row.flags;
    flags.insert(flags.begin(), "--check");  // no server, even if a value is accepted by mistake
    EXPECT_THAT(Refusal(flags), HasSubstr(" " + row.message));  // from the beginning of a word
  }
}

TEST(ServerFlags, ADeviceThatIsNotThereIsRefused) {
  const Words flags = {"--device=gpu", "--idle-exit-seconds=0.1"};
  if (Server(flags).exit_code == 0) GTEST_SKIP() << "there is a device";
  EXPECT_THAT(Refusal(flags), AllOf(HasSubstr("--device=gpu: "), HasSubstr("permitted here: cpu")));
}

// A shell passes an empty value if a variable is not set. The server then takes neither the default
// nor the next flag as the value.
TEST(ServerFlags, AMissingOrEmptyValueIsRefused) {
  EXPECT_THAT(Refusal({"--workers"}), HasSubstr("--workers: 1 required"));
  for (const std::string flag : {"--listen", "--data-dir", "--access-file", "--tls-certificate",
                                 "--metrics-listen", "--backup"}) {
    for (const Words& flags : {Words{flag + "=", "--workers=1"}, Words{flag, "", "--workers=1"}}) {
      EXPECT_THAT(Refusal(flags), HasSubstr(flag + ": needs a value"));
    }
  }
}

TEST(ServerFlags, AServerThatCannotStartSaysWhyAndExits) {
  const TemporaryFolder home;
  WriteFile(home.File("file"), "not a folder");
  const ProcessResult denied = RunServer(home, {"--data-dir", home.File("file/data")});
  EXPECT_THAT(denied, ExitsWith(6));
  EXPECT_THAT(denied.err, HasSubstr("is not writable"));
  EXPECT_THAT(Refusal({"--listen=0.0.0.0:0"}), HasSubstr("give --tls-certificate, --tls-key"));
  for (const std::string metrics : {"0.0.0.0:9090", "unix:/tmp/metrics", "9090"}) {
    EXPECT_THAT(Refusal({"--metrics-listen", metrics, "--idle-exit-seconds=0.1"}),
                HasSubstr("--metrics-listen=" + metrics + " is not a loopback address"));
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
  Write("# of the laboratory\n\n  listen = " + address +
        "\n#the store\n\tdata-dir=" + home_.File("data") +
        "\r\nworkers = 1\nlog-level=info\nmax-points-per-job = 2\n"
        "metrics-listen = 127.0.0.1:0\nmax-active-points-per-principal = 3e7");
  Process server(ServerCommand(home_, {"--config=" + Path()}));
  ASSERT_TRUE(server.WaitForErr("listening on " + address));
  EXPECT_TRUE(server.WaitForErr("metrics at http://127.0.0.1:"));
  EXPECT_TRUE(std::filesystem::exists(home_.File("data/store.sqlite3")));
  const auto status = FromJson<v1::ServerStatus>(
      RunProgram(ClientCommand(home_, {"status", "--format", "json", "--server", address})).out);
  EXPECT_EQ(status.workers(), 1);
  EXPECT_EQ(status.limits().max_points_per_job(), 2);
  EXPECT_EQ(status.limits().max_active_points_per_principal(), 3e7);
}

TEST_F(ConfigFile, CommandLineTakesPrecedence) {
  const std::string text = "data-dir = /of/the/file\nworkers = 1\n";
  EXPECT_THAT(RefusalOf(text, {"--data-dir=/of/the/line", "--check"}),
              HasSubstr("/of/the/line/store.sqlite3"));
  EXPECT_THAT(RefusalOf(text, {"--check"}), HasSubstr("/of/the/file/store.sqlite3"));
}

TEST_F(ConfigFile, HasValuesWithOddCharacters) {
  for (const std::string folder : {"/a#b", "/a # b", "/a b, c", "[::1]:5", "/a=b", "/it's \"a\""}) {
    EXPECT_THAT(RefusalOf("data-dir =  " + folder + "\t\nworkers = 1\n", {"--check"}),
                HasSubstr(" " + folder + "/store"));
  }
}

// The words for sbatch are in the message that it failed.
TEST_F(ConfigFile, EachLineOfAFlagThatMayBeRepeatedCounts) {
  for (const char* tool : {"sbatch", "squeue", "scancel"}) {
    WriteFile(home_.File(tool),
              "#!/bin/sh\n[ ${0##*/} != sbatch ] || { echo \"$@\" >&2; exit 1; }");
    std::filesystem::permissions(home_.File(tool), std::filesystem::perms::owner_all);
  }
  std::filesystem::create_directory(home_.File("shared"));
  std::filesystem::permissions(home_.File("shared"), std::filesystem::perms::owner_all);
  Write(
      "executor = slurm\ncluster-least-seconds = 0\ncluster-worker = /bin/true\n"
      "cluster-folder = " +
      home_.File("shared") + "\nslurm-option = --mem-per-cpu=500M\nslurm-option = --exclusive\n");
  TestServer server({.flags = {"--config", Path()},
                     .launcher = {"env", "PATH=" + home_.File("") + ":" + std::getenv("PATH")}});
  server.Submit(kEndlessQuestion);
  EXPECT_TRUE(server.AwaitLog("--exclusive"));
  const std::string folder = home_.File("shared");
  EXPECT_THAT(
      server.log(),
      HasSubstr(" --chdir=" + folder + " --output=" + folder + "/log/%a.log --wrap=exec '" +
                folder + "/ballpiston-worker' '" + folder + "' --mem-per-cpu=500M --exclusive"));
}

TEST_F(ConfigFile, ARefusalNamesFileLineFlagAndPermittedValues) {
  const struct {
    std::string text;
    int line;
    std::string message;
  } table[] = {
      {"listn = unix:x\n", 1, "not expected: listn"},
      {"\nmax_streams = 3\n", 2, "not expected: max_streams"},
      {"[server]\nworkers = 1\n", 1, "not expected: [server]"},
      {"data-dir\n", 1, "--data-dir: needs a value"},
      {"#\nworkers =\n", 2, "--workers:  is refused; permitted: whole"},
      {"listen = x\nworkers = 0\n", 2, "--workers: 0 is refused; permitted: whole"},
      {"workers = 1\n\nlog-level = info\nworkers = 1\n", 4, "--workers: At Most 1"},
      {"data-dir = a\nworkers = 1\ndata_dir = b\n", 3, "--data-dir: At Most 1"},
  };
  for (const auto& row : table) {
    EXPECT_THAT(
        RefusalOf(row.text, {"--check"}),
        AllOf(HasSubstr(Path() + ":" + std::to_string(row.line) + ": "), HasSubstr(row.message)));
  }
}

TEST_F(ConfigFile, ACommandIsRefused) {
  for (const std::string flag : {"config", "new-token", "check", "backup", "help", "version"}) {
    for (const char* value : {"", " = ", " = true"}) {
      EXPECT_THAT(RefusalOf("workers = 1\n" + flag + value, {"--check"}),
                  HasSubstr(flag + ": This option is not allowed in a configuration file"));
    }
  }
}

TEST_F(ConfigFile, ShippedFileNamesTheFilesThatAPublicServerNeeds) {
  const std::string shipped = SourcePath("server/systemd/ballpistond.conf");
  const std::string certificate = home_.File("certificate.pem");
  // All flags are accepted; only the files do not exist.
  EXPECT_THAT(Refusal({"--config", shipped, "--data-dir", home_.File("data"), "--tls-certificate",
                       certificate}),
              HasSubstr(certificate + ": cannot be opened"));
}

}  // namespace
}  // namespace ballpiston
