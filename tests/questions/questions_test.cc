// Random questions, to the engine and to a real server. README.md says what is checked.
#include "absl/strings/numbers.h"
#include "client/output/spelling.h"
#include "tests/questions/checks.h"
#include "tests/questions/engine.h"
#include "tests/questions/question.h"

namespace ballpiston::questions {
namespace {

struct Size {
  uint64_t seed = 1;
  uint64_t first = 0;
  uint64_t questions = 300;
  // Questions that are planned above this processor time are started and stopped.
  double most_seconds = 0.01;
};

std::optional<uint64_t> FromEnvironment(const char* name) {
  const char* const text = std::getenv(name);
  uint64_t number = 0;
  if (text == nullptr || !absl::SimpleAtoi(text, &number)) return std::nullopt;
  return number;
}

// The size of `make test`, or the one that the environment chooses (README.md).
Size SizeFromEnvironment() {
  Size size;
  if (const auto questions = FromEnvironment("BALLPISTON_QUESTIONS")) {
    static const uint64_t random_seed = std::random_device()();
    size = {.seed = random_seed, .questions = *questions, .most_seconds = 0.1};
  }
  size.seed = FromEnvironment("BALLPISTON_QUESTIONS_SEED").value_or(size.seed);
  size.first = FromEnvironment("BALLPISTON_QUESTIONS_FIRST").value_or(size.first);
  return size;
}

// The number of questions that are printed with the same broken check, experiment and model.
constexpr int kPrintedOfAKind = 3;

// A campaign may be cut short.
constexpr uint64_t kBetweenPrints = 1000;  // questions

std::string ExperimentOf(const v1::EnsembleSpec& spec) {
  return client::Spelling(spec.experiment());
}

std::string ModelOf(const v1::EnsembleSpec& spec) {
  return spec.model() == 0 ? "auto" : client::Spelling(spec.model());
}

using Asker = std::function<Report(const Question&)>;

// Asks many questions, and prints the counts by experiment and outcome. Prints each kind of failure
// when it is found: the broken check, and the command that shows it.
class Campaign {
 public:
  Campaign(const std::string& name, const Size& size, const Asker& ask)
      : name_(name), size_(size), ask_(ask) {}

  // Returns the number of questions that break a check.
  int Run() {
    for (uint64_t i = 0; i < size_.questions; ++i) {
      const uint64_t number = size_.first + i;
      const Question question = Draw(size_.seed, number, size_.most_seconds);
      const Report report = ask_(question);
      ++counts_[ExperimentOf(question.spec)][report.outcome];
      failures_ += !report.findings.empty();
      std::set<std::string> checks;
      for (const Finding& finding : report.findings) {
        if (checks.insert(finding.check).second) Note(number, question, finding);
      }
      if ((i + 1) % kBetweenPrints == 0 || i + 1 == size_.questions) Print(i + 1);
    }
    return failures_;
  }

 private:
  void Note(uint64_t number, const Question& question, const Finding& finding) {
    ++broken_[finding.check];
    const int earlier = kinds_[absl::StrCat(finding.check, " ", ExperimentOf(question.spec), " ",
                                            ModelOf(question.spec))]++;
    if (earlier >= kPrintedOfAKind) return;
    // The output is flushed, because a campaign may take hours.
    std::cout << name_ << ": " << finding.check << ": " << finding.what << "\n  "
              << Command(question.spec) << "\n  (question " << number << " of seed " << size_.seed
              << (question.defect.empty() ? "" : ", with a defect: ") << question.defect << ")"
              << std::endl;
  }

  // A line for each experiment, such as "first-hit: 12 answered, 3 refused".
  void Print(uint64_t asked) const {
    std::cout << "\n" << name_ << ": " << asked << " questions of seed " << size_.seed << "\n";
    for (const auto& [experiment, outcomes] : counts_) {
      const char* before = ": ";
      std::cout << experiment;
      for (const auto& [outcome, count] : outcomes) {
        std::cout << std::exchange(before, ", ") << count << " " << outcome;
      }
      std::cout << "\n";
    }
    for (const auto& [check, count] : broken_)
      std::cout << "broken: " << count << " " << check << "\n";
  }

  const std::string name_;
  const Size size_;
  const Asker& ask_;
  std::map<std::string, std::map<std::string, int>> counts_;  // by experiment and outcome
  std::map<std::string, int> broken_, kinds_;
  int failures_ = 0;  // questions that break a check
};

void ExpectNoFailures(const std::string& name, const Asker& ask) {
  EXPECT_EQ(Campaign(name, SizeFromEnvironment(), ask).Run(), 0)
      << "questions break a check; the commands are above";
}

TEST(Questions, TheEngineKeepsItsPromises) {
  const double most_seconds = SizeFromEnvironment().most_seconds;
  ExpectNoFailures("engine", [&](const Question& question) {
    return InChild([&] { return AskEngine(question, most_seconds); });
  });
}

TEST(Questions, TheServerKeepsItsPromises) {
  ExpectNoFailures("server", ServerAsker(SizeFromEnvironment().most_seconds));
}

}  // namespace
}  // namespace ballpiston::questions
