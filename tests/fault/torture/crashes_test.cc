// The engine kills the server again and again, always for one job: the job fails, others do not.
#include "server/convert/errors.h"
#include "server/status/failpoint.h"
#include "tests/fault/torture/questions.h"

namespace ballpiston::torture {
namespace {

constexpr int kJobs = 10;
constexpr int kDeaths = 3;
constexpr uint64_t kSeedOfTheCrash = 13;
constexpr int kDiedOfAFault = 128 + SIGSEGV;

TEST(Crashes, OneJobFailsAndTheOthersHaveTheirBytes) {
  Findings findings("crashes");
  const std::string failpoint =
      absl::StrCat(std::string(server::kCrashForSeed), ":", kSeedOfTheCrash);
  std::vector<v1::EnsembleSpec> questions;
  for (int i = 0; i < kJobs; ++i) questions.push_back(ManyPoints(2, 20'000 + 1'000 * i));
  const std::vector<Answer> answers = UndisturbedAnswers(questions);
  v1::EnsembleSpec crash = Endless();
  crash.set_seed(kSeedOfTheCrash);
  questions.push_back(crash);
  ConnectedServer server;
  server.Start();
  const client::Client client = server.NewClient();
  std::vector<std::string> names;
  for (const v1::EnsembleSpec& question : questions) {
    names.push_back(OrThrow(client.Create(question)).name());
  }
  server.KillHard();  // before one of the jobs is computed
  for (int life = 0; life < kDeaths; ++life) {
    server.Spawn(failpoint);
    EXPECT_EQ(server.AwaitEnd(), kDiedOfAFault) << server.log();
  }
  server.Spawn(failpoint);
  ASSERT_TRUE(server.AwaitReady()) << server.log();
  const v1::EnsembleJob crashed = AwaitEnd(client, names.back());
  EXPECT_EQ(crashed.state(), v1::EnsembleJob::FAILED) << crashed.ShortDebugString();
  EXPECT_EQ(server::ReasonOf(crashed.error()), "ENGINE_CRASHED");
  int same = 0;
  for (size_t i = 0; i < answers.size(); ++i) {
    const v1::EnsembleJob job = AwaitEnd(client, names[i]);
    EXPECT_EQ(job.state(), v1::EnsembleJob::SUCCEEDED) << job.ShortDebugString();
    same += AnswerOf(OrThrow(client.Results(names[i]))) == answers[i];
  }
  EXPECT_EQ(same, kJobs);
  EXPECT_EQ(server.Stop(), 0);
  EXPECT_THAT(server.log(),
              AllOf(HasSubstr("it is computed alone until its next chunk is stored"),
                    HasSubstr(absl::StrCat("job=", names.back())), HasSubstr("seed: 13")));
  findings.Count("deaths", kDeaths);
  findings.Count("other jobs with the same bytes", same);
}

}  // namespace
}  // namespace ballpiston::torture
