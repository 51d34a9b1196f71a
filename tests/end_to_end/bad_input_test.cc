// Bad input that a real server or figure finds gives a clear message and the right exit code. The
// server continues.
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

struct BadInput {
  std::string command;
  int exit_code;
  Words parts;  // of the message
};

// One row for each kind of mistake that a real server or figure finds. All ranges are tested in
// tests/core/ensemble/ensemble_spec_test.cc, all fields of a request in
// tests/server/rpc/bad_requests_test.cc; the mistakes that the client finds, and errors of jobs and
// connections, are in tests/client/transcripts.
std::vector<BadInput> Table(const std::string& nan, const std::string& million) {
  const std::string first_hit = "run first-hit --delta 0.1 --epsilon 0.1 --exponent 1 --rho 0.53 ";
  return {
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
      {"figure mean-free-time --out " + nan, 2, {"--out: "}},
      {"figure mean-free-time --seconds 3 --out x", 2, {"--seconds: the figure mean-free-time"}},
      {"run --spec " + nan, 2, {"grid.rho[0]", "grid.delta[0]"}},
      {"run --spec " + million, 4, {"too large to be sent: 80000", "at most 4194304"}}};
}

TEST(BadInput, EachIsRejectedWithAMessageAndItsExitCode) {
  const TestServer server;
  const std::string nan = server.folder().File("nan"), million = server.folder().File("million");
  WriteFile(nan, R"({"experiment": "EQUILIBRIUM",
                     "grid": {"rho": ["NaN"], "delta": ["Infinity"]}})");
  std::string numbers = "0.53";
  for (int i = 1; i < 1'000'000; ++i) numbers += ",0.53";
  WriteFile(million,
            R"({"experiment": "EQUILIBRIUM", "grid": {"delta": [0.1], "rho": [)" + numbers + "]}}");
  for (const auto& [command, exit_code, parts] : Table(nan, million)) {
    SCOPED_TRACE(command);
    const ProcessResult result = server.Client(Split(command));
    EXPECT_THAT(result, ExitsWith(exit_code));
    // The result is printed even if its accuracy is too low.
    EXPECT_EQ(result.out.empty(), !absl::StrContains(command, "--budget")) << result.out;
    EXPECT_THAT(result.err, StartsWith("ballpiston: "));
    for (const std::string& part : parts) EXPECT_THAT(result.err, HasSubstr(part));
  }
  // Only one command created a job: the one that missed its tolerance.
  EXPECT_EQ(Length(At(server.Json({"list"}), "jobs")), 1);
}

}  // namespace
}  // namespace ballpiston
