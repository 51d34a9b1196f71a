// Random questions, to the engine and to a real server. README.md says what is checked.
#include "tests/questions/questions.h"

#include "client/output/spelling.h"
#include "tests/support/nightly.h"

namespace ballpiston::questions {
namespace {

struct Size {
  uint64_t seed = 1;
  uint64_t first = 0;
  uint64_t questions = 300;
  // Questions that are planned above this processor time are started and stopped.
  double most_seconds = 0.01;
};

// The size of `make test`, or the one that the environment chooses (README.md).
Size SizeFromEnvironment() {
  Size size;
  if (const auto questions = NumberFromEnvironment("BALLPISTON_QUESTIONS")) {
    static const uint64_t random_seed = std::random_device()();
    size = {.seed = random_seed, .questions = *questions, .most_seconds = 0.1};
  }
  size.seed = NumberFromEnvironment("BALLPISTON_QUESTIONS_SEED").value_or(size.seed);
  size.first = NumberFromEnvironment("BALLPISTON_QUESTIONS_FIRST").value_or(size.first);
  return size;
}

// The number of questions that are printed with the same broken check, experiment and model.
constexpr int kPrintedOfAKind = 3;

// A campaign may be cut short.
constexpr uint64_t kBetweenPrints = 1000;  // questions

using Asker = std::function<std::string(const v1::EnsembleSpec&)>;
using Counts = std::map<std::string, std::map<std::string, int>>;  // by experiment and outcome

// A line for each experiment, such as "first-hit: 12 answered, 3 refused".
void Print(const Counts& counts) {
  for (const auto& [experiment, outcomes] : counts) {
    const char* before = ": ";
    std::cout << experiment;
    for (const auto& [outcome, count] : outcomes) {
      std::cout << std::exchange(before, ", ") << count << " " << outcome;
    }
    std::cout << std::endl;
  }
}

// Asks many questions, and prints the counts by experiment and outcome. When a check is broken, the
// failure has its name, and the command that shows it.
void AskAll(const std::string& name, const Asker& ask) {
  const Size size = SizeFromEnvironment();
  Counts counts;
  std::map<std::string, int> kinds;
  for (uint64_t asked = 1; asked <= size.questions; ++asked) {
    const uint64_t number = size.first + asked - 1;
    const v1::EnsembleSpec question = Draw(size.seed, number, size.most_seconds);
    const std::string experiment = client::Spelling(question.experiment());
    std::string outcome;
    try {
      outcome = ask(question);
    } catch (const Violation& broken) {
      outcome = "broken: " + broken.check;
      if (kinds[absl::StrCat(outcome, experiment, question.model())]++ < kPrintedOfAKind) {
        ADD_FAILURE() << name << ": " << broken.check << ": " << broken.what() << "\n  "
                      << Command(question) << "\n  (question " << number << " of seed " << size.seed
                      << ")";
      }
    }
    ++counts[experiment][outcome];
    if (asked % kBetweenPrints > 0 && asked < size.questions) continue;
    std::cout << "\n" << name << ": " << asked << " questions of seed " << size.seed << "\n";
    Print(counts);
  }
}

TEST(Questions, TheEngineKeepsItsPromises) {
  const double most_seconds = SizeFromEnvironment().most_seconds;
  AskAll("engine", [&](const v1::EnsembleSpec& question) {
    return InChild([&] { return AskEngine(question, most_seconds); });
  });
}

TEST(Questions, TheServerKeepsItsPromises) {
  AskAll("server", ServerAsker(SizeFromEnvironment().most_seconds));
}

}  // namespace
}  // namespace ballpiston::questions
