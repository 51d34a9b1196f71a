#include "tests/questions/campaign.h"

#include "absl/strings/numbers.h"
#include "client/output/spelling.h"

namespace ballpiston::questions {
namespace {

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

class Campaign {
 public:
  Campaign(const std::string& name, const Size& size, const Asker& ask)
      : name_(name), size_(size), ask_(ask) {}

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

std::optional<uint64_t> FromEnvironment(const char* name) {
  const char* const text = std::getenv(name);
  uint64_t number = 0;
  if (text == nullptr || !absl::SimpleAtoi(text, &number)) return std::nullopt;
  return number;
}

}  // namespace

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

int AskAll(const std::string& name, const Size& size, const Asker& ask) {
  return Campaign(name, size, ask).Run();
}

}  // namespace ballpiston::questions
