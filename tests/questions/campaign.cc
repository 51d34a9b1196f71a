#include "tests/questions/campaign.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/output/spelling.h"
#include "tests/questions/child.h"
#include "tests/questions/draw.h"
#include "tests/questions/shrink.h"

namespace ballpiston::questions {
namespace {

// Of questions with the same broken check, experiment and model so many are shrunk; of the rest the
// first few are printed as they were asked.
constexpr int kShrunkOfAKind = 1;
constexpr int kPrintedOfAKind = 3;
constexpr int kMostTrials = 150;
constexpr int kMostTrialsWithoutEnd = 10;  // each takes kMostProcessorSeconds

// A campaign may be cut short.
constexpr uint64_t kBetweenPrints = 1000;  // questions

constexpr double kWrongPlan = 5;
constexpr double kLeastCompared = 0.02;  // s: below it a plan is about overheads
constexpr double kLateCancel = 2;        // s

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
      Count(question, report);
      NotePace(question, report);
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
  void Count(const Question& question, const Report& report) {
    ++counts_[ExperimentOf(question.spec)][report.outcome];
    for (const auto& [check, seconds] : report.seconds) seconds_[check] += seconds;
  }

  void NotePace(const Question& question, const Report& report) {
    const double slow = std::max(report.planned, report.spent);
    const double fast = std::min(report.planned, report.spent);
    if (report.spent > 0 && slow > kLeastCompared && slow > kWrongPlan * fast) {
      wrong_plans_.push_back(absl::StrFormat("planned %.3g s, took %.3g s: %s", report.planned,
                                             report.spent, Command(question.spec)));
    }
    if (report.cancel_seconds > kLateCancel) {
      late_cancels_.push_back(
          absl::StrFormat("%.1f s: %s", report.cancel_seconds, Command(question.spec)));
    }
  }

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
    // A question with a defect stays as it is: without its defect it may be permitted.
    if (earlier >= kShrunkOfAKind || !question.defect.empty()) return;
    std::cout << "  shrunk: " << Command(Simplest(question.spec, finding.check)) << std::endl;
  }

  v1::EnsembleSpec Simplest(const v1::EnsembleSpec& spec, const std::string& check) const {
    const int most = check == kEndCheck ? kMostTrialsWithoutEnd : kMostTrials;
    const auto fails = [&](const v1::EnsembleSpec& simpler) {
      return ask_({.spec = simpler}).Breaks(check);
    };
    return Shrink(spec, fails, most);
  }

  void Print(uint64_t asked) const {
    std::cout << "\n" << name_ << ": " << asked << " questions of seed " << size_.seed << "\n";
    std::set<std::string> outcomes;
    for (const auto& [experiment, of_experiment] : counts_) {
      for (const auto& [outcome, count] : of_experiment) outcomes.insert(outcome);
    }
    PrintCounts(outcomes);
    for (const auto& [check, seconds] : seconds_) {
      std::cout << absl::StrFormat("%-28s %8.2f s\n", check, seconds);
    }
    for (const auto& [check, count] : broken_) {
      std::cout << absl::StrFormat("broken: %-20s %8d\n", check, count);
    }
    if (!size_.is_nightly) return;
    PrintList("plans that were wrong by more than a factor of 5", wrong_plans_);
    PrintList("cancels that took more than 2 s", late_cancels_);
  }

  void PrintCounts(const std::set<std::string>& outcomes) const {
    std::cout << absl::StrFormat("%-28s", "experiment");
    for (const std::string& outcome : outcomes) std::cout << absl::StrFormat(" %9s", outcome);
    std::cout << "\n";
    for (const auto& [experiment, of_experiment] : counts_) {
      std::cout << absl::StrFormat("%-28s", experiment);
      for (const std::string& outcome : outcomes) {
        const auto found = of_experiment.find(outcome);
        std::cout << absl::StrFormat(" %9d", found == of_experiment.end() ? 0 : found->second);
      }
      std::cout << "\n";
    }
  }

  static void PrintList(const char* title, const std::vector<std::string>& lines) {
    std::cout << title << ": " << lines.size() << "\n";
    for (const std::string& line : lines) std::cout << "  " << line << "\n";
  }

  const std::string name_;
  const Size size_;
  const Asker& ask_;
  std::map<std::string, std::map<std::string, int>> counts_;  // by experiment and outcome
  std::map<std::string, double> seconds_;                     // by check
  std::map<std::string, int> broken_, kinds_;
  int failures_ = 0;  // questions that break a check
  std::vector<std::string> wrong_plans_, late_cancels_;
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
    size = {.seed = random_seed, .questions = *questions, .most_seconds = 0.1, .is_nightly = true};
  }
  size.seed = FromEnvironment("BALLPISTON_QUESTIONS_SEED").value_or(size.seed);
  size.first = FromEnvironment("BALLPISTON_QUESTIONS_FIRST").value_or(size.first);
  return size;
}

int AskAll(const std::string& name, const Size& size, const Asker& ask) {
  return Campaign(name, size, ask).Run();
}

}  // namespace ballpiston::questions
