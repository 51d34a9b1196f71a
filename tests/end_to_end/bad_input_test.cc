// Wrong commands of every kind give a clear message and the right exit code; the server goes on.
//
// Prints the table: command, exit code, message.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct BadInput {
  std::string command;  // words separated by blanks; FOLDER stands for the test's folder
  int exit_code;
  std::vector<std::string> parts;  // of the message
};

std::vector<BadInput> Table(const std::string& cancelled) {
  const std::string relaxation = "run energy-relaxation --delta 0.1 --rho 0.53 ";
  const std::string first_hit = "run first-hit --delta 0.1 --epsilon 0.1 --exponent 1 --rho 0.53 ";
  return {
      // rho and delta: which bound, and its value
      {"run equilibrium --rho 0.5 --delta 0.1", 2, {"--rho: "}},
      {"run equilibrium --rho 0.7072 --delta 0.1", 2, {"--rho: ", "0.707"}},
      {"run equilibrium --rho 0.529561127988977 --delta 0.33", 2, {"--delta: ", "0.3255"}},
      {"run equilibrium --rho 0.53 --delta 0", 2, {"--delta: "}},
      {"run equilibrium --rho 0.53 --delta -0.1", 2, {"--delta: "}},
      {"analytic --rho 0.4 --delta 0.1", 2, {"--rho: "}},
      {"analytic --rho 0.529561127988977 --delta 0.33", 2, {"--delta: ", "0.3255"}},
      {"analytic --rho 0.53 --delta 0.1 --epsilon 0.6", 2, {"--epsilon: "}},
      {"analytic --rho 0.53 --delta 0.1 --temperature 1,0",
       2,
       {"--temperature: ", "0 is not in [1e-120, 1e+120]"}},
      // epsilon, exponent, samples
      {"run conditional-mean-free-time --rho 0.53 --delta 0.1 --epsilon 0.50001",
       2,
       {"--epsilon: "}},
      {"run conditional-mean-free-time --rho 0.53 --delta 0.1 --epsilon -1e-9", 2, {"--epsilon: "}},
      {"run first-hit --rho 0.53 --delta 0.1 --epsilon 0.1 --exponent -1", 2, {"--exponent: "}},
      {"run first-hit --rho 0.53 --delta 0.1 --epsilon 0.1 --exponent 1e9", 2, {"--exponent: "}},
      // cells and temperatures
      {first_hit + "--cells 8,4y4",
       2,
       {"--cells: '4y4' is not a shape: write N, a chain of N cells, or NxM, a lattice"}},
      {first_hit + "--cells 4x3,-3,1e9 --temperature 0 --hot 1 --cold 1e121",
       2,
       {"--cells: has 3 values; first-hit does not use this list",
        "--cells: cells is \"-3\"; permitted: N or NxM, 1 to 1000000 cells in all",
        "--cells: ", "--temperature: temperature is 0; permitted: ",
        "--hot: has 1 values; first-hit does not use this list", "--cold: "}},
      // a gas
      {"run gas-equilibrium --rho 0.529561127988977 --delta 0.21 --cells 8 --temperature 1",
       2,
       {"--delta: ", "rho/sqrt(2) - lambda/2 = 0.1999",
        "the bound of a gas, where no two pistons may overlap"}},
      {"run gas-equilibrium --rho 0.53 --delta 0.1 --cells 0,1e9,0x3 --temperature 0",
       2,
       {"--cells: cells is \"0\"; permitted: N or NxM, 1 to 1000000 cells in all",
        "--cells: ", "--cells: ", "--temperature: "}},
      {"run gas-conduction --rho 0.53 --delta 0.1 --cells 8 --hot 1 --cold 2",
       2,
       {"--hot: hot is 1, below cold = 2; permitted: hot >= cold"}},
      {"run gas-conduction --rho 0.53 --delta 0.1 --cells 8 --hot 1 --cold 1 --tolerance 0.1",
       2,
       {"--tolerance: ", "0 if hot = cold = 1"}},
      {"run gas-conduction --rho 0.53 --delta 0.1 --cells 8 --hot 2 --cold 1 --precision single",
       2,
       {"--precision: is single; permitted for a gas: double"}},
      {first_hit + "--samples 0", 2, {"--samples: "}},
      {first_hit + "--samples -5", 2, {"--samples: "}},
      {first_hit + "--samples 1e15", 2, {"--samples: "}},
      {first_hit + "--samples 1.5", 2, {"--samples: '1.5' is not a whole number"}},
      {"run equilibrium --rho 0.53 --delta 0.1 --collisions 0", 2, {"--collisions: "}},
      // tolerance and budget
      {first_hit + "--tolerance 0", 2, {"--tolerance: ", "is 0", "permitted: 0 < tolerance < 1"}},
      {first_hit + "--tolerance -0.1",
       2,
       {"--tolerance: ", "is -0.1", "permitted: 0 < tolerance < 1"}},
      {first_hit + "--tolerance 2", 2, {"--tolerance: ", "is 2"}},
      {first_hit + "--budget -1", 2, {"--budget: "}},
      {first_hit + "--budget 0", 2, {"--budget: ", "is 0 s", "permitted: 0 < budget <= "}},
      {first_hit + "--budget 1e7", 2, {"--budget: ", "is 1e+07 s", "1e+06 s"}},
      {first_hit + "--budget 1 --samples 10", 2, {"--samples and --budget exclude each other"}},
      {first_hit + "--tolerance 1e-6 --budget 0.05",
       4,
       {"point 0", "tolerance 1e-06", "budget of 0.05 s", "reached 0."}},
      {"run equilibrium --rho 0.53 --delta 0.1 --model closed_form --tolerance 1e-17",
       2,
       {"--tolerance: ", "is 1e-17", "closed_form", "tolerance >= "}},
      {relaxation + "--model markov --tolerance 1e-4",
       2,
       {"--tolerance: ", "is 1e-04", "markov", "tolerance >= 0.0"}},
      {relaxation + "--model spectrum --tolerance 1e-4",
       2,
       {"--tolerance: ", "is 1e-04", "spectrum", "tolerance >= 0.0"}},
      // an estimate that is not known, or that the model cannot answer
      {"run gas-equilibrium --rho 0.53 --delta 0.1 --cells 8 --temperature 1 --estimate current",
       2,
       {"--estimate: is current; permitted with gas-equilibrium: exchange_rate, "
        "conductivity"}},
      {"run gas-equilibrium --rho 0.53 --delta 0.1 --cells 8 --temperature 1 --estimate "
       "conductivity --model closed_form",
       2,
       {"--estimate: is conductivity, which model closed_form cannot answer",
        "permitted: exchange_rate, or model auto, spectrum, "}},
      {first_hit + "--estimate conductivity",
       2,
       {"--estimate: ", "permitted with first-hit: mean_hit_time"}},
      // a model that cannot answer
      {relaxation + "--model closed_form",
       2,
       {"--model: is closed_form, which cannot answer energy-relaxation", "permitted: auto, "}},
      {first_hit + "--model spectrum",
       2,
       {"--model: is spectrum, which cannot answer first-hit", "permitted: auto, billiard"}},
      {"run equilibrium --rho 0.53 --delta 0.1 --model markov",
       2,
       {"--model: is markov, which cannot answer equilibrium", "permitted: auto, closed_form"}},
      {"run markov-property --rho 0.53 --delta 0.1 --model spectrum",
       2,
       {"--model: is spectrum, which cannot answer markov-property"}},
      // an initial energy outside
      {relaxation + "--epsilon 0.6", 2, {"--epsilon: ", "is 0.6", "permitted: [0, 0.5]"}},
      {relaxation + "--epsilon -0.1", 2, {"--epsilon: ", "is -0.1", "[0, 0.5]"}},
      {"run markov-property --rho 0.53 --delta 0.1 --epsilon 0.1",
       2,
       {"--epsilon: ", "markov-property does not use this list"}},
      // grids
      {"run equilibrium", 2, {"--rho: ", "--delta: "}},
      {"run equilibrium --rho 0.53 --delta 0.1 --epsilon 0.1", 2, {"--epsilon: "}},
      {"run first-hit --rho 0.51:0.6:1000 --delta 0.001:0.01:1000 --epsilon 0:0.5:1000 "
       "--exponent 1",
       2,
       {"grid: ", "1000000000"}},
      {"run equilibrium --rho 0.51:0.6:1000000000 --delta 0.1",
       2,
       {"--rho: ", "a whole number from 1 to 100000"}},
      {"run equilibrium --rho , --delta 0.1", 2, {"--rho: '' is not a decimal number"}},
      // NaN and infinity, by flag and by file
      {"run equilibrium --rho nan --delta 0.1", 2, {"--rho: 'nan' is not a decimal number"}},
      {"run equilibrium --rho 0.53 --delta inf", 2, {"--delta: 'inf' is not a decimal number"}},
      {"run equilibrium --rho 0.53 --delta 1e999", 2, {"--delta: '1e999'"}},
      {"run --spec FOLDER/nan.json", 2, {"grid.rho[0]", "grid.delta[0]"}},
      // names, and flags that exclude each other
      {"run brownian-motion --rho 0.53", 2, {"EXPERIMENT: 'brownian-motion' is not one of"}},
      {"run first-hot --rho 0.53", 2, {"'first-hot' is not one of", "did you mean first-hit?"}},
      {first_hit + "--model guess", 2, {"--model: 'guess' is not one of auto, "}},
      {first_hit + "--precision half", 2, {"--precision: 'half' is not one of "}},
      {first_hit + "--samples 10 --tolerance 0.1", 2, {"--samples and --tolerance exclude"}},
      {first_hit + "--format xml", 2, {"--format: 'xml'"}},
      {first_hit + "--progress loud", 2, {"--progress: 'loud'"}},
      {first_hit + "--speed 3", 2, {"run has no flag '--speed'; did you mean --seed?"}},
      {"plan equilibrium --rho 0.53", 2, {"--delta: "}},
      {"plan energy-relaxation --rho 0.4 --delta 0.1 --tolerance 0",
       2,
       {"--rho: ", "--tolerance: "}},
      {"plan", 2, {"name an EXPERIMENT"}},
      {"plan brownian-motion --rho 0.53", 2, {"EXPERIMENT: 'brownian-motion' is not one of"}},
      {"dance", 2, {"'dance' is not a verb; verbs are "}},
      {"wach none", 2, {"'wach' is not a verb", "did you mean watch?"}},
      {"run first-hit extra", 2, {"not expected: 'extra'"}},
      {"watch", 2, {"name a JOB, or give --label KEY=VALUE"}},
      {"list --limit 0", 2, {"--limit: 0"}},
      {"list --since yesterday", 2, {"--since: 'yesterday' is not a date (UTC)"}},
      {"list --state runing", 2, {"--state: 'runing'", "did you mean running?"}},
      {"figure portrait --out FOLDER/figure", 2, {"figure 'portrait'"}},
      {"figure mean-free-time --out FOLDER/broken.json", 2, {"--out: "}},
      {"figure mean-free-time --rho 0.4 --out FOLDER/figure", 2, {"--rho: "}},
      {"figure mean-free-time --seconds 3 --out FOLDER/figure",
       2,
       {"--seconds: the figure mean-free-time"}},
      {"figure speed-accuracy --samples 3 --out FOLDER/figure",
       2,
       {"--samples: the figure speed-acc"}},
      // specification files
      {"run --spec FOLDER/broken.json", 2, {"--spec FOLDER/broken.json: "}},
      {"run --spec FOLDER/unknown.json", 2, {"--spec FOLDER/unknown.json: ", "radius"}},
      {"run --spec FOLDER/text.json", 2, {"not a JSON object"}},
      {"run --spec FOLDER/two_targets.json", 2, {"--spec FOLDER/two_targets.json: "}},
      {"run --spec FOLDER/absent.json", 2, {"No such file"}},
      {"run --spec FOLDER", 2, {"is a folder"}},
      {"run --spec FOLDER/empty.json", 2, {"experiment"}},
      {"run --spec FOLDER/broken.json --rho 0.53", 2, {"--spec holds the whole specification"}},
      // every violation at once, each with its field
      {"run first-hit --rho 0.4,0.53,0.8 --delta 0.1 --epsilon 0.7 --exponent -1 --samples 0",
       2,
       {"--rho: ", "--rho: ", "--epsilon: ", "--exponent: ", "--samples: "}},
      // too large to be sent
      {"run --spec FOLDER/million.json", 4, {"too large to be sent: 80000", "at most 4194304"}},
      {"run equilibrium --rho 0.51:0.6:100000,0.61 --delta 0.1",
       2,
       {"--rho: ", "has more than 100000 numbers"}},
      {"analytic --rho 0.53 --delta 0.1 --beta 1:2:60000,1:2:60000",
       2,
       {"--beta: ", "has more than 100000 numbers"}},
      // jobs
      {"result ensembleJobs/none", 5, {"JOB_NOT_FOUND"}},
      {"watch none", 5, {"JOB_NOT_FOUND"}},
      {"cancel none", 5, {"JOB_NOT_FOUND"}},
      {"delete none", 5, {"JOB_NOT_FOUND"}},
      {"result a/b", 2, {"'a/b' is not a job's name"}},
      {"result ensembleJobs/\xff", 2, {"'ensembleJobs/\\xff' is not a job's name"}},
      {"watch \xc3\xa9", 2, {"'\\xc3\\xa9' is not a job's name"}},
      {"delete ABC", 2, {"'ABC' is not a job's name"}},
      {"cancel " + cancelled, 4, {"JOB_ALREADY_ENDED"}},
      {"list --server nowhere", 2, {"'nowhere' is not a server's address"}},
      {"list --server 127.0.0.1:1", 3, {"no answer from the server at 127.0.0.1:1"}},
      {"list --server unix:FOLDER/no.socket", 3, {"no answer from the server at unix:"}}};
}

class BadInputTest : public ::testing::Test {
 protected:
  BadInputTest() {
    Write("broken.json", R"({"experiment": "FIRST_HIT",)");
    Write("unknown.json", R"({"experiment": "EQUILIBRIUM", "grid": {"radius": [0.53]}})");
    Write("text.json", "rho = 0.53");
    Write("empty.json", "{}");
    Write("nan.json", R"({"experiment": "EQUILIBRIUM",
                         "grid": {"rho": ["NaN"], "delta": ["Infinity"]}})");
    std::string million = R"({"experiment": "EQUILIBRIUM", "grid": {"delta": [0.1], "rho": [0.53)";
    for (int i = 1; i < 1'000'000; ++i) million += ",0.53";
    Write("million.json", million + "]}}");
    Write("two_targets.json", R"({"target": {"samples": 1, "tolerance": 0.1}})");
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

  // In the table the test's folder is `DIR`, and a message's lines are joined.
  void Print(const BadInput& input, const ProcessResult& result) const {
    const std::string line = absl::StrReplaceAll(
        absl::StripSuffix(result.err, "\n"), {{server_.folder().path(), "DIR"}, {"\n", "<br>"}});
    std::printf("| `ballpiston %s` | %d | %s |\n",
                absl::CHexEscape(absl::StrReplaceAll(input.command, {{"FOLDER", "DIR"}})).c_str(),
                result.exit_code, line.c_str());
  }

  const TestServer server_;
};

TEST_F(BadInputTest, EachIsRejectedWithAMessageAndItsExitCode) {
  const std::string job = server_.Submit(kEndlessQuestion);
  ASSERT_THAT(server_.Client({"cancel", job}), ExitsWith(0));
  ASSERT_THAT(server_.Client({"watch", job}), ExitsWith(4));
  std::printf("| command | exit | message |\n|---|---|---|\n");
  for (const BadInput& input : Table(job)) {
    const ProcessResult result = Run(input.command);
    Print(input, result);
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
  EXPECT_EQ(Length(At(server_.Json({"list"}), "jobs")), 2);
}

}  // namespace
}  // namespace ballpiston
