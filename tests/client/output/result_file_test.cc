#include "client/output/result_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "client/output/new_file.h"
#include "tests/support/files.h"
#include "tests/support/message_text.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::client {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

TEST(ResultFile, TheEndingSelectsTheFormat) {
  const auto format = [](const char* path, Format asked = Format::kTable) {
    return FormatOfFile(path, asked)->format;
  };
  EXPECT_EQ(format("a/b.json"), Format::kJson);
  EXPECT_EQ(format("b.json", Format::kJson), Format::kJson);
  EXPECT_EQ(format("b.csv"), Format::kCsv);
  EXPECT_EQ(format("b.csv", Format::kCsvHistograms), Format::kCsvHistograms);
  EXPECT_TRUE(FormatOfFile("b.npz", Format::kTable)->is_npz);
}

TEST(ResultFile, OtherEndingsAndContradictionsAreInvalid) {
  for (const char* path : {"result", "result.txt", "json", ".jsonl", ""}) {
    EXPECT_THAT(FormatOfFile(path, Format::kTable),
                StatusIs(kInvalid, HasSubstr(".json, .csv or .npz")));
  }
  EXPECT_THAT(FormatOfFile("b.json", Format::kCsv), StatusIs(kInvalid, HasSubstr("--format")));
  EXPECT_THAT(FormatOfFile("b.npz", Format::kJson), StatusIs(kInvalid, HasSubstr("--format")));
  EXPECT_THAT(FormatOfFile("b.csv", Format::kJsonl), StatusIs(kInvalid, HasSubstr("--format")));
}

// ---- what a file holds ----

v1::EnsembleJob RelaxationJob() {
  return FromText<v1::EnsembleJob>(R"(
    name: "ensembleJobs/abc" state: SUCCEEDED engine_version: "9.8.7"
    spec { experiment: ENERGY_RELAXATION seed: 77 grid { rho: 0.53 delta: [0.2, 0.1] } })");
}

std::vector<v1::PointResult> Points() {
  return {FromText<v1::PointResult>(R"(
            index: 0 parameters { rho: 0.53 delta: 0.2 } model: BILLIARD samples: 100
            estimates { name: "relaxation_time" value: 3.25 standard_error: 0.5 }
            histograms { name: "energy" time: 1 lower: 0 upper: 0.5 counts: [1, 2] }
            histograms { name: "energy" time: 4 lower: 0 upper: 0.5 counts: [3, 4] }
            histograms { name: "alpha" sigma: -1 lower: -1 upper: 1 counts: [5, 6, 7] }
            curves { name: "decay" points { time: 0 value: 1 }
                     points { time: 2 value: 0.5 limit: 0.25 } })"),
          FromText<v1::PointResult>(R"(
            index: 1 parameters { rho: 0.53 delta: 0.1 } model: MARKOV samples: 200
            estimates { name: "relaxation_time" value: 4.5 exact: 4.25 })")};
}

std::string Written(const FileFormat& format) {
  std::ostringstream out;
  const auto writer = NewResultFileWriter(format, out);
  writer->Begin(RelaxationJob());
  for (const v1::PointResult& point : Points()) writer->Add(point);
  writer->End();
  return out.str();
}

TEST(ResultFile, CsvBeginsWithItsProvenance) {
  const std::string csv = Written({Format::kCsv});
  EXPECT_THAT(csv, StartsWith("# ensembleJobs/abc, engine 9.8.7, client " BALLPISTON_VERSION
                              "\n# {\"experiment\":\"ENERGY_RELAXATION\""));
  EXPECT_THAT(csv, HasSubstr("\"seed\":\"77\""));
  EXPECT_THAT(csv, HasSubstr("}\nrho,delta,"));
}

// ---- files ----

class NewFileTest : public ::testing::Test {
 protected:
  std::string Path() const { return folder_.path() + "/result.csv"; }

  TemporaryFolder folder_;
};

TEST_F(NewFileTest, AppearsWhenItIsKept) {
  {
    NewFile file("--save", Path());
    file.out() << "whole" << std::flush;
    EXPECT_FALSE(std::filesystem::exists(Path()));
    EXPECT_OK(file.Keep());
  }
  EXPECT_EQ(Contents(Path()), "whole");
}

TEST_F(NewFileTest, WithoutKeepTheOldFileStays) {
  WriteFile(Path(), "old");
  { NewFile("--save", Path()).out() << "half"; }
  EXPECT_EQ(Contents(Path()), "old");
  const std::filesystem::directory_iterator files(folder_.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

TEST_F(NewFileTest, AFullDiskIsAnError) {
  NewFile file("--save", "/dev/full");
  file.out() << "text";
  EXPECT_THAT(file.Keep(), StatusIs(kInvalid, HasSubstr("--save: cannot write /dev/full")));
}

TEST_F(NewFileTest, AMissingFolderIsFoundBeforeTheWork) {
  const std::string path = folder_.path() + "/none/result.csv";
  EXPECT_THAT(CheckNewFile("--save", path), StatusIs(kInvalid, HasSubstr(path)));
  EXPECT_THAT(CheckNewFile("--save", folder_.path()), StatusIs(kInvalid, HasSubstr("folder")));
  EXPECT_OK(CheckNewFile("--save", Path()));
  EXPECT_THAT(NewFile("--save", path).Keep(), StatusIs(kInvalid, HasSubstr("No such file")));
}

}  // namespace
}  // namespace ballpiston::client
