// The whole program without its main function, in an empty home folder.
#pragma once

#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "client/command/command_line.h"
#include "gtest/gtest.h"
#include "tests/client/fake_server.h"
#include "tests/support/files.h"
#include "tests/support/scoped.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::client {

struct Outcome {
  int code;
  std::string out;
  std::string err;

  bool operator==(const Outcome&) const = default;
  friend std::ostream& operator<<(std::ostream& out, const Outcome& outcome) {
    return out << "exit code " << outcome.code << "\n" << outcome.out << outcome.err;
  }
};

inline Outcome Ballpiston(const std::vector<std::string>& words) {
  std::ostringstream out, err;
  Terminal terminal{out, err};
  const ExitCode code = RunCommandLine(words, terminal);
  return {static_cast<int>(code), out.str(), err.str()};
}

// An empty home folder, and no variables of the program: the user's files and settings have no
// effect. The program of the private server is /bin/false.
class EmptyHome {
 public:
  EmptyHome() {
    for (const Verb& verb : Verbs()) {
      for (const Flag* flag : FlagsOf(verb)) {
        if (!flag->variable.empty()) variables_.try_emplace(flag->variable, flag->variable);
      }
    }
    mkdir(File("ballpiston").c_str(), 0700);  // other users must not write to it
  }

  // XDG_CONFIG_HOME and XDG_STATE_HOME are also this folder.
  std::string File(const std::string& name) const { return folder_.File(name); }
  void WriteConfig(const std::string& text) const {
    WriteFile(File("ballpiston/config.toml"), text);
  }
  // Makes the server at this address the private server.
  void UseAsPrivateServer(const std::string& address) const {
    std::filesystem::create_symlink(address.substr(std::string("unix:").size()),
                                    File("ballpiston/server.socket"));
  }

 private:
  const TemporaryFolder folder_;
  const ScopedVariable home_{"HOME", folder_.path()};
  const ScopedVariable config_home_{"XDG_CONFIG_HOME", folder_.path()};
  const ScopedVariable state_home_{"XDG_STATE_HOME", folder_.path()};
  const ScopedVariable server_program_{"BALLPISTON_SERVER_PROGRAM", "/bin/false"};
  std::map<std::string, ScopedVariable> variables_;
};

// Adds a server with one succeeded job of one point.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest() {
    v1::EnsembleJob job = JobIn(v1::EnsembleJob::SUCCEEDED);
    job.mutable_progress()->set_points(1);
    job.mutable_progress()->set_points_done(1);
    server_.jobs = {job};
    server_.watches = {{{JobMessage(job, "t")}, grpc::Status::OK}};
    v1::Estimate* estimate = server_.points.emplace_back().add_estimates();
    estimate->set_name("mean_hit_time");
    estimate->set_value(1.5);
  }

  // Starts the server, if it does not run yet.
  Outcome WithServer(std::vector<std::string> words) {
    server_.Start();
    words.insert(words.end(), {"--server", server_.Address()});
    return Ballpiston(words);
  }
  v1::EnsembleJob& job() { return server_.jobs[0]; }

  const EmptyHome home_;
  FakeServer server_;
};

}  // namespace ballpiston::client
