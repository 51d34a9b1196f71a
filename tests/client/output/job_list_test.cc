#include "client/output/job_list.h"

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <sstream>

namespace ballpiston::client {
namespace {

std::string Printed(Format format, const std::string& principal = "", int priority = 0) {
  v1::EnsembleJob running;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      R"(name: "ensembleJobs/b" state: RUNNING principal: "ann" spec { experiment: EQUILIBRIUM }
         create_time { seconds: 1700000000 }
         progress { points: 10 points_done: 3 samples: 1234567 })",
      &running));
  v1::EnsembleJob ended;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      R"(name: "ensembleJobs/a" state: SUCCEEDED principal: "ann" spec { experiment: FIRST_HIT }
         create_time { seconds: 0 } end_time { seconds: 60 } progress { points: 1 points_done: 1 })",
      &ended));
  running.set_priority(priority);
  if (!principal.empty()) ended.set_principal(principal);
  std::ostringstream out;
  PrintJobs({running, ended}, format, out);
  return out.str();
}

TEST(JobList, TableIsAligned) {
  EXPECT_EQ(
      Printed(Format::kTable),
      R"(name            experiment   state      done  points  samples  created               ended
ensembleJobs/b  equilibrium  running       3      10  1234567  2023-11-14T22:13:20Z
ensembleJobs/a  first-hit    succeeded     1       1        0  1970-01-01T00:00:00Z  1970-01-01T00:01:00Z
)");
}

TEST(JobList, CsvHasARowForEachJob) {
  EXPECT_EQ(
      Printed(Format::kCsv),
      R"(name,experiment,state,points_done,points,samples,create_time,end_time,principal,priority
ensembleJobs/b,equilibrium,running,3,10,1234567,2023-11-14T22:13:20Z,,ann,0
ensembleJobs/a,first-hit,succeeded,1,1,0,1970-01-01T00:00:00Z,1970-01-01T00:01:00Z,ann,0
)");
}

TEST(JobList, TheTableTellsWhoseAJobIsIfThereAreSeveralPrincipals) {
  const std::string table = Printed(Format::kTable, "bob");
  EXPECT_NE(table.find("  ended                 principal\n"), std::string::npos) << table;
  EXPECT_NE(table.find("Z                        ann\n"), std::string::npos) << table;
  EXPECT_NE(table.find("Z  bob\n"), std::string::npos) << table;
}

TEST(JobList, TheTableTellsPrioritiesIfThereAreAny) {
  const std::string table = Printed(Format::kTable, "", -7);
  EXPECT_NE(table.find("  ended                 priority\n"), std::string::npos) << table;
  EXPECT_NE(table.find("-7\n"), std::string::npos) << table;
  EXPECT_EQ(table.find("ann"), std::string::npos) << table;
}

TEST(JobList, CsvQuotesAPrincipalsNameWhereItHasTo) {
  const std::string csv = Printed(Format::kCsv, "Lab 3, \"the old one\"", 5);
  EXPECT_NE(csv.find("Z,,ann,5\n"), std::string::npos) << csv;
  EXPECT_NE(csv.find("Z,\"Lab 3, \"\"the old one\"\"\",0\n"), std::string::npos) << csv;
}

TEST(JobList, JsonIsOneDocument) {
  const std::string text = Printed(Format::kJson);
  EXPECT_EQ(text.rfind("{\"jobs\": [\n{\"name\":\"ensembleJobs/b\"", 0), 0u);
  EXPECT_NE(text.find(",\n{\"name\":\"ensembleJobs/a\""), std::string::npos);
  EXPECT_EQ(text.substr(text.size() - 4), "\n]}\n");
}

TEST(JobList, JsonlHasAJobALine) {
  const std::string text = Printed(Format::kJsonl);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_EQ(text.rfind("{\"name\":\"ensembleJobs/b\"", 0), 0u);
}

}  // namespace
}  // namespace ballpiston::client
