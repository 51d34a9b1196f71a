#include "client/output/job_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "tests/client/message_text.h"

namespace ballpiston::client {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::string PrintedJobs(Format format, const std::string& principal = "", int priority = 0) {
  auto running = FromText<v1::EnsembleJob>(
      R"(name: "ensembleJobs/b" state: RUNNING principal: "ann" spec { experiment: EQUILIBRIUM }
         create_time { seconds: 1700000000 }
         progress { points: 10 points_done: 3 samples: 1234567 })");
  auto ended = FromText<v1::EnsembleJob>(
      R"(name: "ensembleJobs/a" state: SUCCEEDED principal: "ann" spec { experiment: FIRST_HIT }
         create_time { seconds: 0 } end_time { seconds: 60 } progress { points: 1 points_done: 1 })");
  running.set_priority(priority);
  if (!principal.empty()) ended.set_principal(principal);
  std::ostringstream out;
  PrintJobs({running, ended}, format, out);
  return out.str();
}

TEST(JobList, TableIsAligned) {
  EXPECT_EQ(
      PrintedJobs(Format::kTable),
      R"(name            experiment   state      done  points  samples  created               ended
ensembleJobs/b  equilibrium  running       3      10  1234567  2023-11-14T22:13:20Z
ensembleJobs/a  first-hit    succeeded     1       1        0  1970-01-01T00:00:00Z  1970-01-01T00:01:00Z
)");
}

TEST(JobList, CsvHasARowForEachJob) {
  EXPECT_EQ(
      PrintedJobs(Format::kCsv),
      R"(name,experiment,state,points_done,points,samples,create_time,end_time,principal,priority
ensembleJobs/b,equilibrium,running,3,10,1234567,2023-11-14T22:13:20Z,,ann,0
ensembleJobs/a,first-hit,succeeded,1,1,0,1970-01-01T00:00:00Z,1970-01-01T00:01:00Z,ann,0
)");
}

TEST(JobList, TheTableHasPrincipalsIfThereAreSeveral) {
  const std::string table = PrintedJobs(Format::kTable, "bob");
  EXPECT_THAT(table, HasSubstr("  ended                 principal\n"));
  EXPECT_THAT(table, HasSubstr("Z                        ann\n"));
  EXPECT_THAT(table, HasSubstr("Z  bob\n"));
}

TEST(JobList, TheTableHasPrioritiesIfThereAreAny) {
  const std::string table = PrintedJobs(Format::kTable, "", -7);
  EXPECT_THAT(table, HasSubstr("  ended                 priority\n"));
  EXPECT_THAT(table, HasSubstr("-7\n"));
  EXPECT_THAT(table, Not(HasSubstr("ann")));
}

TEST(JobList, CsvQuotesTheNameOfAPrincipal) {
  const std::string csv = PrintedJobs(Format::kCsv, "Lab 3, \"the old one\"", 5);
  EXPECT_THAT(csv, HasSubstr("Z,,ann,5\n"));
  EXPECT_THAT(csv, HasSubstr("Z,\"Lab 3, \"\"the old one\"\"\",0\n"));
}

TEST(JobList, JsonIsOneDocument) {
  const std::string text = PrintedJobs(Format::kJson);
  EXPECT_THAT(text, StartsWith("{\"jobs\": [\n{\"name\":\"ensembleJobs/b\""));
  EXPECT_THAT(text, HasSubstr(",\n{\"name\":\"ensembleJobs/a\""));
  EXPECT_THAT(text, EndsWith("\n]}\n"));
}

TEST(JobList, JsonlHasALineForEachJob) {
  const std::string text = PrintedJobs(Format::kJsonl);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_THAT(text, StartsWith("{\"name\":\"ensembleJobs/b\""));
}

}  // namespace
}  // namespace ballpiston::client
