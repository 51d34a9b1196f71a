// Bad input that a real server or figure finds gives a clear message and the right exit code. The
// server continues.

#include "absl/strings/str_replace.h"
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

struct BadInput {
  std::string command;  // words separated by blanks; FOLDER stands for the test's folder
  int exit_code;
  std::vector<std::string> parts;  // of the message
};

// One row for each kind of mistake that a real server or figure finds. All ranges are tested in
// tests/core/ensemble/ensemble_spec_test.cc, all fields of a request in
// tests/server/rpc/bad_requests_test.cc; the mistakes that the client finds are in
// tests/client/transcripts/wrong_usage.txt.
std::vector<BadInput> Table() {
  const std::string first_hit = "run first-hit --delta 0.1 --epsilon 0.1 --exponent 1 --rho 0.53 ";
  return {
      // grids, targets and models
      {"run equilibrium", 2, {"--rho: ", "--delta: "}},
      {"run first-hit --rho 0.4,0.53,0.8 --delta 0.1 --epsilon 0.7 --exponent -1 --samples 0",
       2,
       {"--rho: ", "--rho: ", "--epsilon: ", "--exponent: ", "--samples: "}},
      {first_hit + "--cells 4x3,-3,1e9 --temperature 0 --hot 1 --cold 1e121",
       2,
       {"--cells: has 3 values; first-hit does not use this list",
        "--cells: cells is \"-3\"; permitted: N or NxM, 1 to 1000000 cells in all",
        "--temperature: temperature is 0; permitted: ",
        "--hot: has 1 value; first-hit does not use this list", "--cold: "}},
      {"analytic --rho 0.4 --delta 0.1 --epsilon 0.6", 2, {"--rho: ", "--epsilon: "}},
      {first_hit + "--tolerance 0", 2, {"--tolerance: ", "is 0", "permitted: 0 < tolerance < 1"}},
      {first_hit + "--tolerance 1e-6 --budget 0.05",
       4,
       {"point 0", "tolerance 1e-06", "budget of 0.05 s", "reached 0."}},
      {"run energy-relaxation --delta 0.1 --rho 0.53 --model markov --tolerance 1e-4",
       2,
       {"--tolerance: ", "is 1e-04", "markov", "tolerance >= 0.0"}},
      {"plan energy-relaxation --rho 0.4 --delta 0.1 --tolerance 0",
       2,
       {"--rho: ", "--tolerance: "}},
      // figures
      {"figure mean-free-time --out FOLDER/nan.json", 2, {"--out: "}},
      {"figure mean-free-time --seconds 3 --out FOLDER/figure",
       2,
       {"--seconds: the figure mean-free-time"}},
      // files
      {"run --spec FOLDER/nan.json", 2, {"grid.rho[0]", "grid.delta[0]"}},
      {"run --spec FOLDER/million.json", 4, {"too large to be sent: 80000", "at most 4194304"}},
      // jobs and servers
      {"result ensembleJobs/none", 5, {"JOB_NOT_FOUND"}},
      {"list --server 127.0.0.1:1", 3, {"no answer from the server at 127.0.0.1:1"}}};
}

class BadInputTest : public ::testing::Test {
 protected:
  BadInputTest() {
    Write("nan.json", R"({"experiment": "EQUILIBRIUM",
                         "grid": {"rho": ["NaN"], "delta": ["Infinity"]}})");
    std::string million = R"({"experiment": "EQUILIBRIUM", "grid": {"delta": [0.1], "rho": [0.53)";
    for (int i = 1; i < 1'000'000; ++i) million += ",0.53";
    Write("million.json", million + "]}}");
  }

  void Write(const std::string& name, const std::string& text) const {
    WriteFile(server_.folder().File(name), text);
  }

  std::string Replaced(const std::string& text) const {
    return absl::StrReplaceAll(text, {{"FOLDER", server_.folder().path()}});
  }

  ProcessResult Run(const std::string& command) const {
    const Words words = Split(Replaced(command));
    const bool names_server = command.find("--server") != std::string::npos;
    return names_server ? RunProgram(ClientCommand(server_.folder(), words))
                        : server_.Client(words);
  }

  const TestServer server_;
};

TEST_F(BadInputTest, EachIsRejectedWithAMessageAndItsExitCode) {
  for (const BadInput& input : Table()) {
    const ProcessResult result = Run(input.command);
    EXPECT_THAT(result, ExitsWith(input.exit_code)) << input.command;
    // The result is printed even if its accuracy is too low.
    const bool computed = input.command.find("--budget 0.05") != std::string::npos;
    EXPECT_EQ(result.out.empty(), !computed) << input.command << "\n" << result.out;
    EXPECT_THAT(result.err, StartsWith("ballpiston: ")) << input.command;
    for (const std::string& part : input.parts) {
      EXPECT_THAT(result.err, HasSubstr(Replaced(part))) << input.command;
    }
  }
  // Only one command created a job: the one that missed its tolerance.
  EXPECT_EQ(Length(At(server_.Json({"list"}), "jobs")), 1);
}

}  // namespace
}  // namespace ballpiston
