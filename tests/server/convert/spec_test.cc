#include "server/convert/spec.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_replace.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

v1::EnsembleSpec SpecOfText(const std::string& text) { return FromText<v1::EnsembleSpec>(text); }

// Each text may go on, as FromText permits.
const std::string kHit =
    "experiment: FIRST_HIT seed: 18446744073709551615 "
    "grid { rho: 0.53 delta: 0.1 epsilon: 0.25 exponent: 1 } ";
const std::string kGas = "experiment: GAS_EQUILIBRIUM grid { rho: 0.53 delta: 0.1 } ";
const std::string kRelaxation = "experiment: ENERGY_RELAXATION grid { rho: 0.53 delta: 0.1 } ";

// Error messages print the budget, so it is exactly 0.3, and not 0.30000000000000004.
TEST(Spec, ABudgetKeepsItsDecimalDigits) {
  EXPECT_EQ(
      CheckSpec(SpecOfText("target { budget { nanos: 300000000 } }")).spec.target.budget_seconds,
      0.3);
}

// ---- violations ----

std::vector<std::string> ViolatedFields(const CheckedSpec& checked) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : checked.violations) fields.push_back(violation.field);
  return fields;
}

// These violations are possible in messages only. tests/core/ensemble/ensemble_spec_test.cc tests
// the ranges of all fields.
TEST(Spec, EveryBadFieldIsAViolation) {
  struct Row {
    std::string spec;
    std::vector<std::string> fields;  // each has one violation, in this order
    std::string description = {};     // of the first one; empty: not compared
  };
  const std::string range = "; permitted: N or NxM, 1 to 1000000 cells in all";
  const std::string long_text(1'000'000, 'y');
  const std::vector<Row> rows = {
      // Strange text is escaped and shortened.
      {kGas + R"(grid { cells: "\033[2J)" + long_text + "\" }",
       {"spec.grid.cells[0]"},
       "cells is \"\\033[2J" + std::string(96, 'y') + "...\"" + range},
      {kGas + R"(grid { cells: "4" } target { estimate: "\033[2J)" + long_text + "\" }",
       {"spec.target.estimate"},
       "is \\033[2J" + std::string(96, 'y') +
           "...; permitted with gas-equilibrium: exchange_rate, conductivity"},
      {kHit + R"(grid { cells: "4" })",
       {"spec.grid.cells"},
       "has 1 value; first-hit does not use this list"},
      {kHit + "target { budget { seconds: 1 nanos: 1000000000 } }",
       {"spec.target.budget.nanos"},
       "is 1000000000; permitted: 0 to 999999999"},
      {kHit + "target { budget { seconds: 1 nanos: -1 } }", {"spec.target.budget.nanos"}},
      {kHit + "target { budget { nanos: -1 } }", {"spec.target.budget"}},
      {kHit + "precision: 79", {"spec.precision"}},
      {kHit + "model: 78", {"spec.model"}},
      {kHit + "experiment: 77", {"spec.experiment"}},
      // A tolerance below the model's own error.
      {kRelaxation + "target { tolerance: 1e-4 } model: SPECTRUM", {"spec.target.tolerance"}}};
  for (const Row& row : rows) {
    SCOPED_TRACE(row.spec.substr(0, 200));
    const CheckedSpec checked = CheckSpec(SpecOfText(row.spec));
    EXPECT_THAT(ViolatedFields(checked), testing::ElementsAreArray(row.fields));
    if (row.description.empty()) continue;
    EXPECT_EQ(checked.violations.at(0).description, row.description);
  }
}

// A message of 4 MiB may hold two million of them.
TEST(Spec, FieldsOfANewerClientAreRefusedAndSomeOfThemListed) {
  v1::EnsembleSpec message = SpecOfText(kHit);
  const auto add = [&message] {
    message.GetReflection()->MutableUnknownFields(&message)->AddVarint(100, 1);
  };
  add();
  EXPECT_THAT(ViolatedFields(CheckSpec(message)), testing::ElementsAre("spec"));
  for (int i = 0; i < 10'000; ++i) add();
  EXPECT_GE(CheckSpec(message).violations.size(), 1u);
  EXPECT_LE(CheckSpec(message).violations.size(), 1000u);
}

// A message of 4 MiB holds two million empty texts.
TEST(Spec, ATooLongListOfShapesIsNotParsed) {
  v1::EnsembleSpec message = SpecOfText(kHit);
  for (int i = 0; i <= kMaxPoints; ++i) message.mutable_grid()->add_cells("");
  EXPECT_THAT(ViolatedFields(CheckSpec(message)),
              testing::UnorderedElementsAre("spec.grid", "spec.grid.cells"));
  message.mutable_grid()->mutable_cells()->RemoveLast();
  EXPECT_EQ(CheckSpec(message).violations.size(), static_cast<size_t>(kMaxPoints) + 1);
}

// ---- defaults and names ----

TEST(Spec, EmptyListsGetDefaultValuesAndNumbersHaveOneForm) {
  const auto with_defaults = [](const std::string& text) {
    v1::EnsembleSpec spec = SpecOfText(text);
    Normalize(spec);
    return spec.ShortDebugString();
  };
  EXPECT_EQ(with_defaults(kGas), SpecOfText(kGas + "grid { temperature: 1 }").ShortDebugString());
  for (const std::string& text : {kGas + "grid { temperature: 2 }", kHit}) {
    EXPECT_EQ(with_defaults(text), SpecOfText(text).ShortDebugString());
  }
  const std::string zeros = "target { tolerance: 0 } grid { rho: 0.53 epsilon: [0, 0.1] hot: 0 }";
  EXPECT_EQ(with_defaults(absl::StrReplaceAll(zeros, {{" 0 ", " -0.0 "}, {"[0", "[-0.0"}})),
            SpecOfText(zeros).ShortDebugString());
  EXPECT_EQ(with_defaults(R"(grid { cells: ["03", "3x02", "x"] })"),
            SpecOfText(R"(grid { cells: ["3", "3x2", "x"] })").ShortDebugString());
}

TEST(Spec, EveryValueOfEveryEnumerationIsKnown) {
  const auto* experiments = v1::EnsembleSpec::Experiment_descriptor();
  EXPECT_EQ(experiments->value_count() - 1, std::ssize(AllExperiments()));
  for (int e = 1; e < experiments->value_count(); ++e) {
    const std::string& name = experiments->value(e)->name();
    const ExperimentKind* kind = CheckSpec(SpecOfText("experiment: " + name)).spec.experiment;
    ASSERT_NE(kind, nullptr) << name;
    EXPECT_EQ(absl::AsciiStrToLower(absl::StrReplaceAll(name, {{"_", "-"}})), kind->name);
  }
  const auto* models = v1::EnsembleSpec::Model_descriptor();
  for (int m = 0; m < models->value_count(); ++m) {
    const std::string& name = models->value(m)->name();
    const auto back = SpecMessage(CheckSpec(SpecOfText("precision: SINGLE model: " + name)).spec);
    EXPECT_EQ(v1::EnsembleSpec::Model_Name(back.model()), m == 0 ? "AUTO" : name);
    EXPECT_EQ(back.precision(), v1::EnsembleSpec::SINGLE);
  }
}

}  // namespace
}  // namespace ballpiston::server
