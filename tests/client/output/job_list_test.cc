#include "client/output/job_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "tests/support/message_text.h"

namespace ballpiston::client {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const absl::Time kNow = absl::FromUnixSeconds(1700000000);

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
  PrintJobs({running, ended}, kNow, format, out);
  return out.str();
}

// The text in the column `results`, in a table of this job and a job whose results stay.
std::string ResultsColumn(const std::string& job) {
  std::ostringstream out;
  PrintJobs({FromText<v1::EnsembleJob>("name: 'ensembleJobs/a' state: SUCCEEDED " + job),
             FromText<v1::EnsembleJob>("name: 'ensembleJobs/b' state: SUCCEEDED")},
            kNow, Format::kTable, out);
  const std::vector<std::string> lines = absl::StrSplit(out.str(), '\n');
  const size_t column = lines.at(0).find("results");
  return column == std::string::npos ? "no column" : lines.at(1).substr(column);
}

// A job whose results expire this long after now.
std::string Expiring(absl::Duration left) {
  const int64_t seconds = absl::ToUnixSeconds(kNow + left);
  return absl::StrCat("expire_time { seconds: ", seconds, " }");
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
      R"(name,experiment,state,points_done,points,samples,create_time,end_time,principal,priority,pinned,expire_time,results_expired,stored_bytes,labels
ensembleJobs/b,equilibrium,running,3,10,1234567,2023-11-14T22:13:20Z,,ann,0,false,,false,0,
ensembleJobs/a,first-hit,succeeded,1,1,0,1970-01-01T00:00:00Z,1970-01-01T00:01:00Z,ann,0,false,,false,0,
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

TEST(JobList, TheTableShowsTheExpiryOfResults) {
  EXPECT_EQ(ResultsColumn("pinned: true"), "pinned");
  EXPECT_EQ(ResultsColumn("results_expired: true " + Expiring(absl::Hours(-1))), "expired");
  EXPECT_EQ(ResultsColumn("pinned: true " + Expiring(absl::Hours(1))), "pinned");
  const std::pair<absl::Duration, std::string> table[] = {
      {absl::Hours(24 * 7), "expires in 7 days"},    {absl::Hours(24 * 4 - 1), "expires in 3 days"},
      {absl::Hours(47), "expires in 1 day"},         {absl::Hours(24), "expires in 1 day"},
      {absl::Hours(23), "expires in 23 hours"},      {absl::Minutes(119), "expires in 1 hour"},
      {absl::Minutes(59), "expires within an hour"}, {absl::Hours(-9), "expires within an hour"}};
  for (const auto& [left, text] : table) EXPECT_EQ(ResultsColumn(Expiring(left)), text);
}

TEST(JobList, TheTableOmitsTheColumnIfAllResultsStay) {
  EXPECT_EQ(ResultsColumn(""), "no column");
  EXPECT_EQ(ResultsColumn(Expiring(absl::Hours(24 * 7) + absl::Seconds(1))), "no column");
}

TEST(JobList, CsvAndJsonShowTheExpiryOfResults) {
  const auto job = FromText<v1::EnsembleJob>(
      R"(pinned: true expire_time { seconds: 1700000000 } results_expired: true
         stored_bytes: 70048)");
  std::ostringstream csv, json;
  PrintJobs({job}, kNow, Format::kCsv, csv);
  PrintJobs({job}, kNow, Format::kJsonl, json);
  EXPECT_THAT(csv.str(), EndsWith(",true,2023-11-14T22:13:20Z,true,70048,\n"));
  for (const char* field : {"\"pinned\":true", "\"expire_time\":\"2023-11-14T22:13:20Z\"",
                            "\"results_expired\":true", "\"stored_bytes\":70048"}) {
    EXPECT_THAT(json.str(), HasSubstr(field));
  }
}

TEST(JobList, OnlyJsonShowsGrids) {
  EXPECT_EQ(JobViewFor(Format::kTable), v1::ListEnsembleJobsRequest::BASIC);
  EXPECT_EQ(JobViewFor(Format::kCsv), v1::ListEnsembleJobsRequest::BASIC);
  EXPECT_EQ(JobViewFor(Format::kJson), v1::ListEnsembleJobsRequest::FULL);
  EXPECT_EQ(JobViewFor(Format::kJsonl), v1::ListEnsembleJobsRequest::FULL);
}

TEST(JobList, CsvQuotesTheNameOfAPrincipal) {
  const std::string csv = PrintedJobs(Format::kCsv, "Lab 3, \"the old one\"", 5);
  EXPECT_THAT(csv, HasSubstr("Z,,ann,5,"));
  EXPECT_THAT(csv, HasSubstr("Z,\"Lab 3, \"\"the old one\"\"\",0,"));
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
