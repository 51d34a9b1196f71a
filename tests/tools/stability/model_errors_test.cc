// The stated errors of the models against differences that were measured once, and stored.
#include "tools/stability/model_errors.h"

#include "absl/strings/numbers.h"
#include "tests/core/preamble.h"

namespace ballpiston::stability {
namespace {

constexpr char kFile[] = "tests/data/model_errors.csv";

// claim, place, difference, standard_error
std::string LineOf(const ModelError& error) {
  return absl::StrFormat("%s,%s,%.4g,%.2g", ClaimOf(error.question), PlaceOf(error.question),
                         error.difference, error.standard_error);
}

// One line for each question, in their order.
std::vector<ModelError> StoredErrors() {
  std::vector<ModelError> errors;
  std::ifstream file(SourcePath(kFile));
  std::string line;
  std::getline(file, line);
  for (const EnsembleSpec& question : ModelErrorQuestions()) {
    std::getline(file, line);
    const std::vector<std::string> cells = absl::StrSplit(line, ',');
    ModelError error = {.question = question};
    if (cells.size() != 4 || cells[0] != ClaimOf(question) || cells[1] != PlaceOf(question) ||
        !absl::SimpleAtod(cells[2], &error.difference) ||
        !absl::SimpleAtod(cells[3], &error.standard_error)) {
      ADD_FAILURE() << kFile << " has '" << line << "' in the place of " << ClaimOf(question)
                    << " at " << PlaceOf(question);
      return {};
    }
    errors.push_back(error);
  }
  EXPECT_FALSE(std::getline(file, line)) << line;
  return errors;
}

TEST(ModelErrors, StatedErrorsCoverTheStoredDifferences) {
  EXPECT_THAT(BrokenClaims(StoredErrors()), IsEmpty());
}

// Two measurements of one difference, with other samples: more than five errors of the smaller one
// apart in 6e-7 of all cases.
TEST(ModelErrors, AMeasurementAgreesWithTheStoredOne) {
  const ModelError stored = StoredErrors().front();
  const ModelError quick = MeasuredModelError(stored.question, 0.1);
  EXPECT_LT(std::fabs(quick.difference - stored.difference), 5 * quick.standard_error);
  EXPECT_GT(quick.standard_error, 2 * stored.standard_error);
}

// Measures all places again and writes the file, three minutes of one core:
//   BALLPISTON_MODEL_ERRORS=1 build/release/bin/stability_test --gtest_filter='ModelErrors.*File'
TEST(ModelErrors, MakesTheFile) {
  if (std::getenv("BALLPISTON_MODEL_ERRORS") == nullptr) GTEST_SKIP() << "takes minutes";
  std::ofstream file(SourcePath(kFile));
  file << "claim,place,difference,standard_error\n";
  for (const EnsembleSpec& question : ModelErrorQuestions()) {
    file << LineOf(MeasuredModelError(question, 1)) << std::endl;
  }
}

}  // namespace
}  // namespace ballpiston::stability
