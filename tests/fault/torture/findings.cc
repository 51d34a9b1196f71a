#include "tests/fault/torture/findings.h"

#include <cstdio>

#include "absl/strings/str_cat.h"

namespace ballpiston::torture {
namespace {

constexpr size_t kReported = 20;

struct Row {
  std::string section, what, value;
};

std::vector<Row>& Rows() {
  static auto* const rows = new std::vector<Row>;
  return *rows;
}

void AddRow(const std::string& section, const std::string& what, const std::string& value) {
  Rows().push_back({section, what, value});
}

void PrintRow(const std::string& section, const std::string& what, const std::string& value) {
  std::printf("| %-21s | %-52s | %19s |\n", section.c_str(), what.c_str(), value.c_str());
}

}  // namespace

Findings::~Findings() {
  for (const auto& [what, count] : counts_) AddRow(section_, what, absl::StrCat(count));
  for (const auto& [what, value] : notes_) AddRow(section_, what, value);
  if (judged_) AddRow(section_, "promises broken", absl::StrCat(wrong_.size()));
}

void Findings::Count(const std::string& what, int64_t by) {
  const std::lock_guard lock(mutex_);
  counts_[what] += by;
}

void Findings::Note(const std::string& what, const std::string& value) {
  const std::lock_guard lock(mutex_);
  notes_[what] = value;
}

void Findings::Wrong(const std::string& what) {
  const std::lock_guard lock(mutex_);
  wrong_.push_back(what);
}

int64_t Findings::count(const std::string& what) const {
  const std::lock_guard lock(mutex_);
  const auto found = counts_.find(what);
  return found == counts_.end() ? 0 : found->second;
}

std::string Findings::Report() const {
  const std::lock_guard lock(mutex_);
  judged_ = true;
  std::string text;
  for (size_t i = 0; i < wrong_.size() && i < kReported; ++i)
    absl::StrAppend(&text, wrong_[i], "\n");
  if (wrong_.size() > kReported) absl::StrAppend(&text, "and ", wrong_.size() - kReported, " more");
  return text;
}

void PrintTable() {
  if (Rows().empty()) return;
  std::printf("\n");
  PrintRow("test", "what", "counted or measured");
  PrintRow(std::string(21, '-'), std::string(52, '-'), std::string(19, '-'));
  std::string section;  // named in its first row
  for (const Row& row : Rows()) {
    PrintRow(row.section == section ? "" : row.section, row.what, row.value);
    section = row.section;
  }
}

}  // namespace ballpiston::torture
