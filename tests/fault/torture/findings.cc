#include "tests/fault/torture/findings.h"

#include <cstdio>

#include "absl/strings/str_cat.h"

namespace ballpiston::torture {
namespace {

constexpr size_t kReported = 20;

std::vector<std::string>& Rows() {
  static auto* const rows = new std::vector<std::string>;
  return *rows;
}

void AddRow(const std::string& section, const std::string& what, const std::string& value) {
  char row[200];
  std::snprintf(row, sizeof(row), "| %-22s | %-46s | %24s |", section.c_str(), what.c_str(),
                value.c_str());
  Rows().emplace_back(row);
}

}  // namespace

Findings::~Findings() {
  for (const auto& [what, count] : counts_) AddRow(section_, what, absl::StrCat(count));
  for (const auto& [what, value] : notes_) AddRow(section_, what, value);
  AddRow(section_, "promises broken", absl::StrCat(wrong_.size()));
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
  std::string text;
  for (size_t i = 0; i < wrong_.size() && i < kReported; ++i)
    absl::StrAppend(&text, wrong_[i], "\n");
  if (wrong_.size() > kReported) absl::StrAppend(&text, "and ", wrong_.size() - kReported, " more");
  return text;
}

void PrintTable() {
  if (Rows().empty()) return;
  std::printf("\n");
  for (const std::string& row : Rows()) std::printf("%s\n", row.c_str());
}

}  // namespace ballpiston::torture
