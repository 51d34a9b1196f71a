// Random questions, to the engine and to a real server. README.md says what is checked.
#include "tests/questions/campaign.h"
#include "tests/questions/engine.h"
#include "tests/questions/real_server.h"

namespace ballpiston::questions {
namespace {

void ExpectNoFailures(const std::string& name, const Asker& ask) {
  EXPECT_EQ(AskAll(name, SizeFromEnvironment(), ask), 0)
      << "questions break a check; the commands are above";
}

TEST(Questions, TheEngineKeepsItsPromises) {
  const double most_seconds = SizeFromEnvironment().most_seconds;
  ExpectNoFailures("engine", [&](const Question& question) {
    return InChild([&] { return AskEngine(question, most_seconds); });
  });
}

TEST(Questions, TheServerKeepsItsPromises) {
  RealServer server(SizeFromEnvironment().most_seconds);
  ExpectNoFailures("server", [&](const Question& question) { return server.Ask(question); });
}

}  // namespace
}  // namespace ballpiston::questions
