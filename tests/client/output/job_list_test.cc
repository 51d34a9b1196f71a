#include "client/output/job_list.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

const absl::Time kNow = absl::FromUnixSeconds(1700000000);

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

}  // namespace
}  // namespace ballpiston::client
